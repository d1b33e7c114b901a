#include <algorithm>
#include <cmath>
#include <limits>

#include "infer/eval/measure/scores.h"
#include "infer/eval/scenes/scenes.h"

namespace lte::infer {
namespace {

/// Of the first method that was measured; below all errors where none was.
double worst_block(const SceneOutcome& scene) {
  for (const MethodOutcome& method : scene.methods) {
    if (method.not_measured.empty() && method.figures.irradiance.measured())
      return method.figures.irradiance.block_error;
  }
  return -1;
}

}  // namespace

MethodSummary summary_of(const ScenesResult& result, size_t method) {
  MethodSummary out;
  std::vector<double> worth, wall, processor;
  double logarithms = 0;
  for (const SceneOutcome& scene : result.scenes) {
    if (scene.methods.empty()) continue;
    const MethodOutcome& outcome = scene.methods[method];
    if (!outcome.not_measured.empty()) continue;
    const MethodFigures& figures = outcome.figures;
    wall.push_back(figures.seconds.wall);
    processor.push_back(figures.seconds.processor);
    if (!figures.irradiance.measured()) continue;
    ++out.of;
    out.right += figures.irradiance.is_right() ? 1 : 0;
    if (!(figures.irradiance.worth > 0)) continue;
    worth.push_back(figures.irradiance.worth);
    logarithms += std::log(figures.irradiance.worth);
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  out.worth_mean = worth.empty() ? none : std::exp(logarithms / static_cast<double>(worth.size()));
  out.worth_least = worth.empty() ? none : *std::min_element(worth.begin(), worth.end());
  out.worth_median = median_of(worth);
  out.seconds = {median_of(wall), median_of(processor)};
  return out;
}

std::vector<size_t> worst_first(const ScenesResult& result) {
  std::vector<size_t> order(result.scenes.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) {
    return worst_block(result.scenes[i]) > worst_block(result.scenes[j]);
  });
  return order;
}

}  // namespace lte::infer
