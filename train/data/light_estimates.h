// How the light estimates of a data set were made: what a model that reads them is bound to.
#pragma once

#include <string>

#include "lte/data/dataset.h"
#include "lte/nn/config.h"

namespace lte::train {

/// Fewest paths a side whose spread gives a standard error.
inline constexpr int kMinPathsOfError = 4;

/// The default is that of files that do not say.
struct LightEstimates {
  int paths = data::kDefaultLightPaths;  ///< a side of each scene point
  int depth = data::kDefaultLightDepth;  ///< surface hits of a path
};

/// Makes sure that a model which reads light sees it as it did before.
/// @param file  that holds the model, for the message
/// @param seen  what the model has been trained with
/// @param data  what the data set has
/// @throws lte::Error if `model` reads light estimates and these differ in what it reads
void check_light_estimates(const std::string& file, const nn::ModelConfig& model,
                           const LightEstimates& seen, const LightEstimates& data);

}  // namespace lte::train
