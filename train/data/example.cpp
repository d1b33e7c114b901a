#include "train/data/example.h"

#include <algorithm>
#include <array>

#include <ATen/ops/empty.h>

#include "lte/base/check.h"
#include "lte/data/light_groups.h"
#include "lte/data/sample_rows.h"

namespace lte::train {
namespace {

/// [rows, 3] of value(row).
template <typename Value>
at::Tensor triples(const std::vector<int64_t>& rows, const Value& value) {
  at::Tensor out = at::empty({static_cast<int64_t>(rows.size()), 3}, at::kFloat);
  auto* values = reinterpret_cast<Vec3*>(out.data_ptr<float>());
  for (size_t i = 0; i < rows.size(); ++i) values[i] = value(static_cast<size_t>(rows[i]));
  return out;
}

/// PointSet::indirect_error of the groups' light under their gains.
at::Tensor light_errors(const TrainingScene& scene, const Symmetry& symmetry,
                        const std::vector<int64_t>& rows) {
  const size_t M = scene.position.size();
  at::Tensor out = at::empty({static_cast<int64_t>(rows.size()), 2}, at::kFloat);
  auto* values = out.data_ptr<float>();
  for (size_t i = 0; i < rows.size(); ++i) {
    data::ErrorOfSum front, back;
    for (int64_t g = 0; g < scene.light_groups; ++g) {
      const auto group = static_cast<int32_t>(g);
      const size_t at = static_cast<size_t>(g) * M + static_cast<size_t>(rows[i]);
      front.add(to_float(scene.error[at]),
                symmetry.light(scene.indirect[at] - scene.indirect_back[at], group));
      back.add(to_float(scene.error_back[at]), symmetry.light(scene.indirect_back[at], group));
    }
    values[2 * i] = front.relative();
    values[2 * i + 1] = back.relative();
  }
  return out;
}

/// PointSet::gloss.
at::Tensor gloss_of(const TrainingScene& scene, const std::vector<int64_t>& rows) {
  at::Tensor out = at::empty({static_cast<int64_t>(rows.size()), 2}, at::kFloat);
  auto* values = out.data_ptr<float>();
  for (size_t i = 0; i < rows.size(); ++i) {
    values[2 * i] = scene.metallic[static_cast<size_t>(rows[i])];
    values[2 * i + 1] = scene.roughness[static_cast<size_t>(rows[i])];
  }
  return out;
}

nn::PointSet gather_points(const TrainingScene& scene, const Symmetry& symmetry,
                           const std::vector<int64_t>& rows) {
  nn::PointSet points;
  points.position = triples(rows, [&](size_t i) { return symmetry.space(scene.position[i]); });
  points.normal = triples(rows, [&](size_t i) { return symmetry.space(scene.normal[i]); });
  points.albedo = triples(rows, [&](size_t i) { return symmetry.color(scene.albedo[i]); });
  points.emission =
      triples(rows, [&](size_t i) { return symmetry.light(scene.emission[i], scene.light[i]); });
  const std::vector<float> area = data::kept_areas(scene.light, scene.area, rows);
  points.area = at::empty({static_cast<int64_t>(rows.size())}, at::kFloat);
  std::copy(area.begin(), area.end(), points.area.data_ptr<float>());
  const size_t M = scene.position.size();
  const auto lit = [&](const std::vector<Rgb>& by_group) {
    if (by_group.empty()) return at::Tensor();
    return triples(rows, [&](size_t i) {
      Rgb sum{};
      for (int64_t g = 0; g < scene.light_groups; ++g) {
        sum += symmetry.light(by_group[static_cast<size_t>(g) * M + i], static_cast<int32_t>(g));
      }
      return sum;
    });
  };
  points.direct = lit(scene.direct);
  points.indirect = lit(scene.indirect);
  points.direct_back = lit(scene.direct_back);
  points.indirect_back = lit(scene.indirect_back);
  if (!scene.error.empty()) points.indirect_error = light_errors(scene, symmetry, rows);
  if (!scene.metallic.empty()) points.gloss = gloss_of(scene, rows);
  return points;
}

}  // namespace

Example Example::to(at::Device device) const {
  Example out = *this;
  std::vector<at::Tensor*> tensors = out.points.tensors();
  tensors.insert(tensors.end(),
                 {&out.queries.position, &out.queries.normal, &out.queries.albedo, &out.target,
                  &out.radiance.queries.position, &out.radiance.queries.normal,
                  &out.radiance.queries.albedo, &out.radiance.directions, &out.radiance.target});
  for (at::Tensor* tensor : tensors) {
    if (tensor->defined()) *tensor = tensor->to(device);
  }
  return out;
}

QueryOptions query_options(const TrainConfig& config) {
  return {config.data.queries_per_scene,
          {config.data.radiance_points, config.data.radiance_directions}};
}

Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                     const std::vector<int64_t>& scene_rows, const QueryOptions& queries,
                     Rng* rng) {
  LTE_CHECK(static_cast<int64_t>(symmetry.gains.size()) == scene.light_groups, scene.name, ": ",
            scene.light_groups, " light groups, but ", symmetry.gains.size(), " gains");
  Example example;
  example.scene = scene.name;
  example.points = gather_points(scene, symmetry, scene_rows);
  const std::vector<int64_t> rows = data::draw_rows(scene.query_points(), queries.count, rng);
  example.queries.position =
      triples(rows, [&](size_t i) { return symmetry.space(scene.query_position[i]); });
  example.queries.normal =
      triples(rows, [&](size_t i) { return symmetry.space(scene.query_normal[i]); });
  example.queries.albedo =
      triples(rows, [&](size_t i) { return symmetry.color(scene.query_albedo[i]); });
  const auto N = static_cast<size_t>(scene.query_points());
  const std::array<double, 3> factor = nn::target_factors(nn::emission_scale(example.points));
  example.target = triples(rows, [&](size_t i) {
    std::array<double, 3> sum{};
    for (int64_t g = 0; g < scene.light_groups; ++g) {
      const Rgb part =
          symmetry.light(scene.target[static_cast<size_t>(g) * N + i], static_cast<int32_t>(g));
      for (int c = 0; c < 3; ++c) sum[static_cast<size_t>(c)] += part[c];
    }
    return Rgb{static_cast<float>(sum[0] * factor[0]), static_cast<float>(sum[1] * factor[1]),
               static_cast<float>(sum[2] * factor[2])};
  });
  example.seed = rng->next_u64();
  if (!scene.incident.empty())
    example.radiance = make_radiance_example(scene, symmetry, factor, queries.radiance, rng);
  return example;
}

}  // namespace lte::train
