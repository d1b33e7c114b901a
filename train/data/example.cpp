#include "train/data/example.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

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

struct DrawnQueries {
  std::vector<int64_t> rows;
  std::vector<double> weight;  ///< of each row; empty: all alike
};

/// Systematic sampling of the scores' distribution: how often a row comes differs by less than one
/// from how often it should on average.
DrawnQueries draw_by_score(const std::vector<float>& scores, bool square_root, int64_t count,
                           Rng* rng) {
  const auto score = [&](size_t i) { return square_root ? std::sqrt(scores[i]) : scores[i]; };
  const auto rows = static_cast<double>(scores.size());
  double total = 0;
  for (size_t i = 0; i < scores.size(); ++i) total += score(i);
  DrawnQueries drawn;
  const double start = rng->uniform();
  double before = 0;  // expected number of draws of the rows so far
  for (size_t i = 0; i < scores.size(); ++i) {
    const double likelier = total > 0 ? 0.5 + 0.5 * score(i) * rows / total : 1.0;
    const bool last = i + 1 == scores.size();  // rounding must not cost a draw
    const double after =
        last ? static_cast<double>(count) : before + static_cast<double>(count) * likelier / rows;
    const auto copies =
        static_cast<int64_t>(std::floor(after + start) - std::floor(before + start));
    for (int64_t copy = 0; copy < copies; ++copy) {
      drawn.rows.push_back(static_cast<int64_t>(i));
      drawn.weight.push_back(1 / likelier);
    }
    before = after;
  }
  return drawn;
}

DrawnQueries draw_queries(const TrainingScene& scene, const QueryOptions& options, Rng* rng) {
  const int64_t rows = scene.query_points();
  if (options.sampling == QuerySampling::Uniform || options.count == 0 || options.count >= rows)
    return {data::draw_rows(rows, options.count, rng), {}};
  const bool by_noise = options.sampling == QuerySampling::Variance;
  return draw_by_score(by_noise ? scene.scores.noise : scene.scores.slope, by_noise, options.count,
                       rng);
}

/// Divides the weights by 1 + λ n. With I = exp(x) − 1, a relative error r of I is an error of
/// r I/(I + 1) of x, which the loss divides by x + ε.
void weigh_noise(const TrainingScene& scene, const QueryOptions& options, const at::Tensor& target,
                 DrawnQueries* drawn) {
  if (drawn->weight.empty()) drawn->weight.assign(drawn->rows.size(), 1.0);
  const auto* I = target.const_data_ptr<float>();
  double before = 0, after = 0;
  for (size_t i = 0; i < drawn->rows.size(); ++i) {
    double factor = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double value = I[3 * i + c];
      const double relative = value / ((value + 1) * (std::log1p(value) + options.epsilon));
      factor += relative * relative / 3;
    }
    const double noise = scene.scores.noise[static_cast<size_t>(drawn->rows[i])] * factor;
    before += drawn->weight[i];
    drawn->weight[i] /= 1 + options.noise_weight * noise;
    after += drawn->weight[i];
  }
  for (double& weight : drawn->weight) weight *= before / after;
}

}  // namespace

Example Example::to(at::Device device) const {
  Example out = *this;
  std::vector<at::Tensor*> tensors = out.points.tensors();
  tensors.insert(tensors.end(),
                 {&out.queries.position, &out.queries.normal, &out.queries.albedo, &out.target,
                  &out.weight, &out.radiance.queries.position, &out.radiance.queries.normal,
                  &out.radiance.queries.albedo, &out.radiance.directions, &out.radiance.target});
  for (at::Tensor* tensor : tensors) {
    if (tensor->defined()) *tensor = tensor->to(device);
  }
  return out;
}

QueryOptions query_options(const TrainConfig& config) {
  return {config.data.queries_per_scene,
          config.data.query_sampling,
          config.noise_weight,
          config.loss.epsilon,
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
  DrawnQueries drawn = draw_queries(scene, queries, rng);
  const std::vector<int64_t>& rows = drawn.rows;
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
  if (queries.noise_weight > 0) weigh_noise(scene, queries, example.target, &drawn);
  if (!drawn.weight.empty()) {
    example.weight = at::empty({static_cast<int64_t>(drawn.weight.size())}, at::kFloat);
    std::copy(drawn.weight.begin(), drawn.weight.end(), example.weight.data_ptr<float>());
  }
  example.seed = rng->next_u64();
  if (!scene.incident.empty())
    example.radiance = make_radiance_example(scene, symmetry, factor, queries.radiance, rng);
  return example;
}

}  // namespace lte::train
