// solve_light on the CPU: radiosity::solve() on tensors.
#include <span>

#include "lte/ops/solve_light.h"
#include "lte/ops/solve_light_args.h"
#include "lte/radiosity/point_radiosity.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

std::span<const Vec3> triples(const at::Tensor& t) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return {reinterpret_cast<const Vec3*>(t.const_data_ptr<float>()), static_cast<size_t>(t.size(0))};
}

at::Tensor solve_light_cpu(const at::Tensor& position, const at::Tensor& normal,
                           const at::Tensor& albedo, const at::Tensor& emission,
                           const at::Tensor& area) {
  check_solve_light_args(position, normal, albedo, emission, area);
  const auto M = static_cast<size_t>(position.size(0));
  const radiosity::PointIrradiance light =
      radiosity::solve({triples(position), triples(normal), triples(albedo), triples(emission),
                        std::span(area.const_data_ptr<float>(), M)},
                       /*groups=*/1);
  at::Tensor out = at::empty({position.size(0), SolvedColumn::kCount}, position.options());
  auto* rows = reinterpret_cast<Rgb*>(out.data_ptr<float>());
  for (size_t i = 0; i < M; ++i) {
    *rows++ = light.direct[i];
    *rows++ = light.indirect[i];
    *rows++ = light.direct_back[i];
    *rows++ = light.indirect_back[i];
  }
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("solve_light", lte::ops::solve_light_cpu); }
