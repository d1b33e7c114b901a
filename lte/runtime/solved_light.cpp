#include "lte/runtime/solved_light.h"

#include "lte/ops/solve_light.h"

namespace lte::runtime {

bool solves_light_of(const nn::PointSet& points, const nn::ModelConfig& config) {
  return config.solves_light() && !points.direct.defined() && !points.indirect.defined();
}

nn::PointSet with_solved_light(nn::PointSet points, const nn::ModelConfig& config) {
  if (!solves_light_of(points, config)) return points;
  const auto plain = [](const at::Tensor& t) { return t.to(at::kFloat).contiguous(); };
  const at::Tensor light =
      ops::solve_light(plain(points.position), plain(points.normal), plain(points.albedo),
                       plain(points.emission), plain(points.area));
  using Column = ops::SolvedColumn;
  const auto column = [&](int64_t first) { return light.narrow(1, first, 3).contiguous(); };
  points.direct = column(Column::kDirect);
  points.indirect = column(Column::kIndirect);
  points.direct_back = column(Column::kDirectBack);
  points.indirect_back = column(Column::kIndirectBack);
  return points;
}

}  // namespace lte::runtime
