// What a radiance decoder learns from one scene in one step: points, directions, and the radiance
// that arrives there.
#pragma once

#include <array>
#include <cstdint>

#include "lte/base/random.h"
#include "lte/nn/points/point_set.h"
#include "train/data/augment.h"
#include "train/data/scene_store.h"

namespace lte::train {

/// Undefined tensors where the model predicts no radiance.
struct RadianceExample {
  nn::QuerySet queries;   ///< P points
  at::Tensor directions;  ///< [P, N, 3]
  at::Tensor target;      ///< [P, N, 3] π times radiance over the points' emission scale

  bool defined() const { return target.defined(); }
};

struct RadianceOptions {
  int64_t points = 0;      ///< of a scene; 0: all
  int64_t directions = 0;  ///< of each point; 0: all
};

/// Draws points, and of each point cells of its hemisphere, and applies `symmetry`.
///
/// Cells have equal projected solid angle, so a cell drawn evenly is a direction of the density
/// cosθ/π, and a plain mean over them is the mean under the cosine: ∫ f cosθ dω/π is estimated by
/// f cosθ/(π pdf) with pdf = cosθ/π. Each cell's direction is its centre.
/// @param factors  nn::target_factors() of the scene points under the symmetry
RadianceExample make_radiance_example(const TrainingScene& scene, const Symmetry& symmetry,
                                      const std::array<double, 3>& factors,
                                      const RadianceOptions& options, Rng* rng);

}  // namespace lte::train
