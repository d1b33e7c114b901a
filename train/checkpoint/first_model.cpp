#include "train/checkpoint/first_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <torch/types.h>
#include <torch/utils.h>

#include "lte/base/check.h"
#include "train/checkpoint/init_weights.h"
#include "train/data/batch.h"

namespace lte::train {

namespace {

constexpr const char* kRadiance = "radiance.";

bool keeps_radiance_fresh(const OptimConfig& train) {
  return std::find(train.init_except.begin(), train.init_except.end(), kRadiance) !=
         train.init_except.end();
}

/// Copies what gathers light from around a query from the irradiance decoder to the radiance
/// decoder, but for the head, whose answers are others: where latents lie and what they say is
/// learnt already.
void begin_radiance_as_irradiance(const nn::LightTransportModel& model) {
  const torch::NoGradGuard no_grad;
  const std::string of = "decoder.", to = concat(kRadiance, "query.");
  auto parameters = model->named_parameters();
  for (auto& item : parameters) {
    const std::string& name = item.key();
    if (!name.starts_with(to) || name.starts_with(to + "head.")) continue;
    const at::Tensor& known = parameters[of + name.substr(to.size())];
    at::Tensor value = item.value();
    // Where the radiance decoder reads more, the columns of that come last.
    if (value.dim() == 2 && value.size(1) > known.size(1)) {
      value.narrow(1, known.size(1), value.size(1) - known.size(1)).zero_();
      value = value.narrow(1, 0, known.size(1));
    }
    value.copy_(known);
  }
}

}  // namespace

nn::LightTransportModel first_model(TrainConfig* config, RunData* data) {
  // A split that is all but black must not push the output's bias to −infinity.
  constexpr double kMinMean = 1e-3;
  config->model.scale = data->scale;
  if (config->model.reads_light()) {
    config->model.output_mean = 1;  // such a network answers with a factor
  } else if (!config->has_output_mean) {
    config->model.output_mean = std::max(mean_target(*config, &data->train), kMinMean);
  }
  LTE_CHECK(std::isfinite(config->model.output_mean), config->data.root,
            ": the mean of the normalized reference is not finite; are there absurd radiances?");
  torch::manual_seed(config->seed);
  nn::LightTransportModel model(config->model);
  if (config->train.init_weights.empty()) return model;
  init_weights(config->train.init_weights, config->train.init_except, model, data->light);
  if (keeps_radiance_fresh(config->train)) begin_radiance_as_irradiance(model);
  return model;
}

}  // namespace lte::train
