// Error on the validation split, with the weights that would be shipped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lte/nn/loss.h"
#include "lte/nn/model.h"
#include "train/data/example.h"
#include "train/loop/scene_loss.h"

namespace lte::train {

/// Errors of the scenes of one kind, as of one data set among several that were joined.
struct KindErrors {
  std::string kind;
  int64_t scenes = 0;
  double loss = 0, mse = 0;  ///< means over them
};

/// Errors of radiance by direction, of models that predict it: π L over the emission scale.
struct RadianceErrors {
  double loss = 0;
  double relmse = 0, bias = 0;  ///< as those of irradiance
};

/// Errors of irradiance over the emission scalar. They are means over scenes, so that each scene
/// counts once, however many queries it has.
struct ValidationResult {
  double loss = 0;         ///< what training lowers: that of radiance included
  double loss_median = 0;  ///< over scenes: a few hard ones rule the mean
  double mse = 0;
  /// Mean over scenes of 10 log10(peak² / MSE), where peak is the scene's largest reference value.
  double psnr = 0;
  double relmse = 0;                                   ///< mean of (Î − I)² / (I² + 0.01)
  double bias = 0;                                     ///< mean of Î − I over the mean of I
  std::vector<std::pair<std::string, double>> scenes;  ///< loss of each, by name
  /// By scene_kind(), in alphabetical order; empty if all are of one.
  std::vector<KindErrors> kinds;
  std::optional<RadianceErrors> radiance;

  /// Names and values of a line of the log: "val_loss", ..., and of each kind "val_loss_box", ...
  std::vector<std::pair<std::string, double>> fields() const;
};

/// "home" of "home_00012": a scene's name without its number.
std::string scene_kind(const std::string& scene);

/// Of an even number of values the mean of the two in the middle; 0 of none.
double median(std::vector<double> values);

/// Runs the model in evaluation mode and without gradients, and puts its mode back.
ValidationResult validate(nn::LightTransportModel& model, const std::vector<Example>& examples,
                          const SceneLossConfig& config, at::Device device);

}  // namespace lte::train
