// The loss of scenes that went through the network together: of irradiance, radiance, or both.
#pragma once

#include <vector>

#include "lte/nn/loss.h"
#include "lte/nn/model.h"
#include "train/config.h"
#include "train/data/example.h"

namespace lte::train {

/// What is compared, and how.
struct SceneLossConfig {
  nn::LossConfig loss;
  double irradiance_weight = 1;  ///< TrainConfig::irradiance_weight

  explicit SceneLossConfig(const TrainConfig& config)
      : loss(config.loss), irradiance_weight(config.irradiance_weight) {}
};

/// Of each scene a scalar: irradiance_weight times the loss of irradiance, and, of models that
/// predict it, that of radiance; each as the configuration has it. Differentiable.
/// @param values  of the queries
std::vector<at::Tensor> scene_losses(nn::LightTransportModel& model, const nn::SceneBatch& batch,
                                     const std::vector<Example>& examples,
                                     const SceneLossConfig& config,
                                     nn::Values values = nn::Values::Checked);

/// Whether gradients go to any parameter of what makes latents.
bool trains_encoder(const nn::LightTransportModel& model);

/// Freezes parameters whose rate_factor() is 0: the backward pass leaves them out.
void freeze_parameters(const OptimConfig& config, nn::LightTransportModel& model);

}  // namespace lte::train
