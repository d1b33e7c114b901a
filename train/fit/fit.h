// An embedding that answers one scene best: the encoder's is the start, and its latents go on to
// learn what paths find in that scene. The decoder stays the model's, so every program that reads
// the model's embeddings reads this one.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/embedding.h"

namespace lte::train {

struct FitSettings {
  /// Wall-clock time of all, of which paths take half.
  double seconds = std::numeric_limits<double>::infinity();
  /// Limits that do not depend on the machine: points that are learnt, and steps.
  int64_t points = int64_t{1} << 20;
  int64_t steps = std::numeric_limits<int64_t>::max();
  uint64_t seed = 0;
  /// Told of what goes on, and of the share of the time that is over. May be null.
  std::function<void(const char* what, double share)> progress;
};

/// Errors of indirect irradiance at points that are not learnt, against paths.
struct FitError {
  double relative_mse = 0;  ///< mean squared error over the mean square, noise of paths taken off
  double rms = 0;           ///< root of the mean squared error, W/m²
};

struct Fit {
  runtime::SceneEmbedding embedding;
  FitError before, after;
  int64_t points = 0;  ///< that were learnt
  int64_t held_out = 0, rays = 0, steps = 0, latents = 0;
  double trace_s = 0, learn_s = 0;
};

/// @param start  of this scene, by a model that predicts irradiance alone
/// @note Where no state of the latents beats the start at points kept for that, it is the start.
/// @throws lte::Error if no light arrives at the scene's surfaces, the model predicts radiance, or
///         the loss is not finite
Fit fit_embedding(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                  const runtime::SceneEmbedding& start, const FitSettings& settings);

}  // namespace lte::train
