#include "train/checkpoint/first_model.h"

#include <algorithm>
#include <cmath>

#include <torch/utils.h>

#include "lte/base/check.h"
#include "train/checkpoint/init_weights.h"
#include "train/data/batch.h"

namespace lte::train {

nn::LightTransportModel first_model(TrainConfig* config, RunData* data) {
  // A split that is all but black must not push the output's bias to −infinity.
  constexpr double kLeastMean = 1e-3;
  config->model.scale = data->scale;
  if (config->model.reads_indirect()) {
    config->model.output_mean = 1;  // such a network answers with a factor
  } else if (!config->has_output_mean) {
    config->model.output_mean = std::max(mean_target(*config, &data->train), kLeastMean);
  }
  LTE_CHECK(std::isfinite(config->model.output_mean), config->data.root,
            ": the mean of the normalized reference is not finite; are there absurd radiances?");
  torch::manual_seed(config->seed);
  nn::LightTransportModel model(config->model);
  if (!config->train.init_weights.empty())
    init_weights(config->train.init_weights, config->train.init_except, model, data->light);
  return model;
}

}  // namespace lte::train
