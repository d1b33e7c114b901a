// The model that a run begins with.
#pragma once

#include "lte/nn/model.h"
#include "train/config.h"
#include "train/data/run_data.h"

namespace lte::train {

/// Makes the model on the CPU, with weights drawn from the seed, or with those of the file that
/// train.init_weights names; a radiance decoder that stays fresh gathers light as the irradiance
/// decoder of that file does. Sets what the data decide of the model's configuration: scale, and
/// output_mean unless it is given.
/// @throws lte::Error if the data have no finite mean, or as init_weights()
nn::LightTransportModel first_model(TrainConfig* config, RunData* data);

}  // namespace lte::train
