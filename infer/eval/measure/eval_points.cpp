#include "infer/eval/measure/eval_points.h"

#include <algorithm>

#include "lte/data/light_groups.h"

namespace lte::infer {
namespace {

constexpr double kRelativeFloor = 1e-2;  // of image::relative_mse

std::vector<Rgb> scaled(std::span<const Rgb> values, double factor) {
  return data::sum_groups(values, 1, factor);
}

}  // namespace

ReferenceNoise EvalPoints::noise() const {
  ReferenceNoise out;
  if (variance.empty()) return out;
  for (size_t i = 0; i < variance.size(); ++i) {
    out.mse += variance[i];
    for (int c = 0; c < 3; ++c) {
      const double y = reference[i][c];
      out.relmse += variance[i] / (3 * (y * y + kRelativeFloor));
    }
  }
  const auto count = static_cast<double>(variance.size());
  return {out.mse / count, out.relmse / count};
}

EvalPoints query_eval_points(const data::SceneSample& sample, double radiance) {
  EvalPoints points;
  points.queries = {sample.query_position, sample.query_normal, sample.query_albedo};
  points.reference = data::sum_groups(sample.indirect, sample.light_groups, 1 / radiance);
  points.direct = data::sum_groups(sample.direct, sample.light_groups, 1 / radiance);
  points.path_traced = scaled(sample.path_traced_64, 1 / radiance);
  for (const float variance : sample.variance)
    points.variance.push_back(static_cast<float>(variance / (radiance * radiance)));
  return points;
}

ViewPixels::ViewPixels(const data::View& view, int64_t groups, double radiance) {
  const auto masked = [&](const auto& values) {
    std::decay_t<decltype(values)> out;
    for (size_t i = 0; i < values.size(); ++i) {
      if (view.mask[i]) out.push_back(values[i]);
    }
    return out;
  };
  position = masked(view.position);
  normal = masked(view.normal);
  albedo = masked(view.albedo);
  points.queries = {position, normal, albedo};
  points.reference = masked(data::sum_groups(view.indirect, groups, 1 / radiance));
  points.direct = masked(data::sum_groups(view.direct, groups, 1 / radiance));
  points.path_traced = masked(scaled(view.path_traced_64, 1 / radiance));
  for (size_t i = 0; i < data::kFewPaths.size(); ++i)
    points.path_traced_few[i] = masked(scaled(view.path_traced_few[i], 1 / radiance));
  points.variance = masked(view.variance);
  for (float& variance : points.variance)
    variance = static_cast<float>(variance / (radiance * radiance));
}

double single_path_variance(const data::SceneSample& sample, double radiance) {
  double sum = 0;
  for (size_t i = 0; i < sample.variance.size(); ++i) {
    const auto paths =
        static_cast<double>(sample.query_rays.empty() ? sample.rays : sample.query_rays[i]);
    sum += sample.variance[i] * paths;
  }
  const auto count = static_cast<double>(std::max<size_t>(1, sample.variance.size()));
  return sum / (count * radiance * radiance);
}

}  // namespace lte::infer
