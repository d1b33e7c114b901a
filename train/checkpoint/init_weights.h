// A new run that starts from the weights of another one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/nn/model.h"
#include "train/data/light_estimates.h"

namespace lte::train {

/// Copies the weights of a model file, or of a checkpoint (the averaged ones if it has any), into
/// `model`. Names and shapes must match one by one. Parameters whose names begin with one of
/// `except` are left out on both sides and keep the model's fresh values. Settings that differ
/// without changing a shape, and so change what the weights mean, draw a warning. One that
/// predicts radiance takes the weights of one that does not; gloss has no effect at first. One that
/// is some whole times as wide is widened (widen.h) and begins with the same answers.
/// @param except  prefixes of parameter names, "decoder.head." say; each must be of some parameter
/// @param light   how the data set estimates the light that the model reads
/// @throws lte::Error naming the file: unreadable, neither model nor checkpoint, trained at another
/// scale than the model's or with other light estimates, of another format version, values that are
/// not finite; or, in one line, all parameters that are missing, superfluous or of another shape
void init_weights(const std::filesystem::path& path, const std::vector<std::string>& except,
                  const nn::LightTransportModel& model, const LightEstimates& light = {});

}  // namespace lte::train
