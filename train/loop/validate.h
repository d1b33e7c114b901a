// Error on the validation split, with the weights that would be shipped.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lte/nn/loss.h"
#include "lte/nn/model.h"
#include "train/data/example.h"

namespace lte::train {

/// Means over scenes, so that each counts once whatever its queries; all of irradiance over the
/// emission scalar.
struct ValidationResult {
  double loss = 0;
  double loss_median = 0;  ///< over scenes: a few hard ones rule the mean
  double mse = 0;
  double psnr =
      0;  ///< mean over scenes of 10 log10(peak² / MSE), peak: the scene's largest reference value
  double relmse = 0;                                   ///< mean of (Î − I)² / (I² + 0.01)
  double bias = 0;                                     ///< mean of Î − I over the mean of I
  std::vector<std::pair<std::string, double>> scenes;  ///< loss of each, by name

  /// Names and values of a line of the log: "val_loss", ...
  std::vector<std::pair<std::string, double>> fields() const;
};

/// In evaluation mode and without gradients; the model's mode is as before afterwards.
ValidationResult validate(nn::LightTransportModel& model, const std::vector<Example>& examples,
                          const nn::LossConfig& loss, at::Device device);

}  // namespace lte::train
