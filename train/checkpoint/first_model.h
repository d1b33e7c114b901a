// The model that a run begins with.
#pragma once

#include "lte/nn/model.h"
#include "train/config.h"
#include "train/data/run_data.h"

namespace lte::train {

/// Drawn from the seed, on the CPU; its weights are those of train.init_weights where that names a
/// file. Sets what of the model's configuration the data decide: scale, and output_mean unless it
/// is given.
/// @throws lte::Error if the data have no finite mean, or as init_weights()
nn::LightTransportModel first_model(TrainConfig* config, RunData* data);

}  // namespace lte::train
