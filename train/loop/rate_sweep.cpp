#include "train/loop/rate_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/progress.h"
#include "train/checkpoint/first_model.h"
#include "train/data/batch.h"
#include "train/loop/scene_gradients.h"
#include "train/loop/step_gradient.h"
#include "train/optim/optimizer.h"

namespace lte::train {
namespace {

constexpr double kSmoothing = 0.95, kBlownUp = 4;

/// Written so that a loss that is no number has blown up too.
bool blown_up(const std::vector<RatePoint>& points) {
  const auto lowest = std::min_element(
      points.begin(), points.end(),
      [](const RatePoint& a, const RatePoint& b) { return a.smoothed < b.smoothed; });
  return !(points.back().smoothed <= kBlownUp * lowest->smoothed);
}

}  // namespace

RateSweep read_sweep(std::vector<RatePoint> points, bool diverged) {
  LTE_CHECK(points.size() >= 3, "the loss was no number any more after ", points.size(),
            " steps at the lowest rate; are data and model sound?");
  RateSweep sweep;
  sweep.diverged = diverged;
  const auto lowest = std::min_element(
      points.begin(), points.end(),
      [](const RatePoint& a, const RatePoint& b) { return a.smoothed < b.smoothed; });
  sweep.lowest = lowest->rate;
  // Over a tenth of the sweep, so that the noise of single scenes does not decide.
  const auto end = static_cast<size_t>(lowest - points.begin());
  const size_t reach = std::max<size_t>(1, points.size() / 20);
  double fall = 0;
  sweep.steepest = points[end].rate;
  for (size_t i = reach; i + reach <= end; ++i) {
    const RatePoint &before = points[i - reach], &after = points[i + reach];
    const double slope = (after.smoothed - before.smoothed) / std::log(after.rate / before.rate);
    if (slope >= fall) continue;
    fall = slope;
    sweep.steepest = points[i].rate;
  }
  sweep.suggestion = std::min(sweep.steepest, sweep.lowest / 10);
  sweep.points = std::move(points);
  return sweep;
}

RateSweep sweep_rates(const TrainConfig& given, at::Device device, int64_t steps) {
  TrainConfig config = given;
  config.train.steps = steps;
  RunData data = open_run_data(config);
  nn::LightTransportModel model = first_model(&config, &data);
  model->to(device);
  model->train();
  Optimizer optimizer(config.train, model);
  SceneGradients gradients(config, model, device);
  BatchLoader loader(config, data.scale, &data.train);
  lte::Progress line("sweeping", steps, "steps");
  std::vector<RatePoint> points;
  double mean = 0, weight = 0;
  for (int64_t step = 0; step < steps; ++step) {
    const std::vector<Example> examples = loader.take(step);
    StepGradient gradient;
    RatePoint point;
    const double position = static_cast<double>(step) / static_cast<double>(steps - 1);
    point.rate = kLowestRate * std::pow(kHighestRate / kLowestRate, position);
    try {
      gradient = step_gradient(examples, step, &gradients, &optimizer);
    } catch (const Error&) {
      // Weights blown up beyond what the network accepts: what the sweep looks for. The first steps
      // hardly move them, so there it is a fault.
      if (step < 3) throw;
      return read_sweep(std::move(points), true);
    }
    point.loss = gradient.loss;
    mean = kSmoothing * mean + (1 - kSmoothing) * point.loss;
    weight = kSmoothing * weight + (1 - kSmoothing);
    point.smoothed = mean / weight;
    points.push_back(point);
    if (!std::isfinite(gradient.norm) || blown_up(points))
      return read_sweep(std::move(points), true);
    optimizer.update(step, gradient.norm, point.rate);
    line.advance();
  }
  return read_sweep(std::move(points), false);
}

void write_sweep(const std::filesystem::path& path, const RateSweep& sweep) {
  std::string text;
  for (size_t i = 0; i < sweep.points.size(); ++i) {
    const RatePoint& point = sweep.points[i];
    text += nlohmann::ordered_json{{"step", i + 1},
                                   {"lr", point.rate},
                                   {"loss", point.loss},
                                   {"smoothed_loss", point.smoothed}}
                .dump() +
            '\n';
  }
  write_file(path, text);
}

}  // namespace lte::train
