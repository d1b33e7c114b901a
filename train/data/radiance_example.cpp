#include "train/data/radiance_example.h"

#include <numbers>
#include <vector>

#include <ATen/ops/empty.h>

#include "lte/base/half.h"
#include "lte/data/sample_rows.h"
#include "train/data/example.h"

namespace lte::train {
namespace {

/// Directions and light of the drawn cells of one point.
class CellReader {
 public:
  CellReader(const TrainingScene& scene, const Symmetry& symmetry,
             const std::array<double, 3>& factors)
      : scene_(scene), field_(scene.incident), symmetry_(symmetry), factors_(factors) {}

  int64_t cells() const { return static_cast<int64_t>(field_.direction.size()); }

  Vec3 direction(size_t point, size_t cell) const {
    const Vec3 normal = field_.normal[point], tangent = field_.tangent[point],
               local = field_.direction[cell];
    return symmetry_.space(tangent * local.x + cross(normal, tangent) * local.y + normal * local.z);
  }

  /// π times the radiance of all light groups under their gains, over the emission scale.
  Rgb light(size_t point, size_t cell) const {
    std::array<double, 3> sum{};
    for (int64_t g = 0; g < scene_.light_groups; ++g) {
      Rgb radiance = value(field_.indirect, static_cast<size_t>(g), point, cell);
      if (!field_.direct.empty())
        radiance += value(field_.direct, static_cast<size_t>(g), point, cell);
      const Rgb part = symmetry_.light(radiance, static_cast<int32_t>(g));
      for (int c = 0; c < 3; ++c) sum[static_cast<size_t>(c)] += part[c];
    }
    const double scale = std::numbers::pi * field_.scale[point];
    Rgb out;
    for (int c = 0; c < 3; ++c)
      out[c] = static_cast<float>(sum[static_cast<size_t>(c)] * scale *
                                  factors_[static_cast<size_t>(c)]);
    return out;
  }

 private:
  Rgb value(const std::vector<Half>& values, size_t group, size_t point, size_t cell) const {
    const auto P = static_cast<size_t>(field_.points()), cells = field_.direction.size();
    const Half* rgb = &values[((group * P + point) * cells + cell) * 3];
    return {to_float(rgb[0]), to_float(rgb[1]), to_float(rgb[2])};
  }

  const TrainingScene& scene_;
  const data::IncidentField& field_;
  const Symmetry& symmetry_;
  const std::array<double, 3>& factors_;
};

/// [rows, 3] of value(i) for i below `rows`.
template <typename Value>
at::Tensor rows_of(size_t rows, const Value& value) {
  at::Tensor out = at::empty({static_cast<int64_t>(rows), 3}, at::kFloat);
  auto* values = reinterpret_cast<Vec3*>(out.data_ptr<float>());
  for (size_t i = 0; i < rows; ++i) values[i] = value(i);
  return out;
}

}  // namespace

RadianceExample make_radiance_example(const TrainingScene& scene, const Symmetry& symmetry,
                                      const std::array<double, 3>& factors,
                                      const RadianceOptions& options, Rng* rng) {
  const data::IncidentField& field = scene.incident;
  const CellReader reader(scene, symmetry, factors);
  const std::vector<int64_t> points = data::draw_rows(field.points(), options.points, rng);
  std::vector<std::pair<size_t, size_t>> drawn;  // point and cell
  for (const int64_t point : points) {
    for (const int64_t cell : data::draw_rows(reader.cells(), options.directions, rng))
      drawn.emplace_back(static_cast<size_t>(point), static_cast<size_t>(cell));
  }
  const auto P = static_cast<int64_t>(points.size()),
             N = static_cast<int64_t>(drawn.size()) / std::max<int64_t>(1, P);
  const auto at_point = [&](const std::vector<Vec3>& values, size_t i) {
    return values[static_cast<size_t>(points[i])];
  };
  RadianceExample example;
  example.queries.position =
      rows_of(points.size(), [&](size_t i) { return symmetry.space(at_point(field.position, i)); });
  example.queries.normal =
      rows_of(points.size(), [&](size_t i) { return symmetry.space(at_point(field.normal, i)); });
  example.queries.albedo =
      rows_of(points.size(), [&](size_t i) { return symmetry.color(at_point(field.albedo, i)); });
  const auto of_cells = [&](const auto& value) {
    return rows_of(drawn.size(), [&](size_t i) { return value(drawn[i].first, drawn[i].second); })
        .view({P, N, 3});
  };
  example.directions =
      of_cells([&](size_t point, size_t cell) { return reader.direction(point, cell); });
  example.target = of_cells([&](size_t point, size_t cell) { return reader.light(point, cell); });
  return example;
}

}  // namespace lte::train
