// The light on scene points read between them as irradiance caching does: a mean over near points
// that face the query's way and lie in its plane (Ward et al. 1988, "A Ray Tracing Solution for
// Diffuse Interreflection", and the normal and plane weights of edge-avoiding filters). The network
// starts near the answer with it, and corrects what it blurs.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lte/nn/config.h"
#include "lte/ops/knn.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// The prior at queries.
struct LightReading {
  /// [Q, 3], positive where the scene has bounced light in that channel; 1 without any point.
  at::Tensor irradiance;
  /// [Q, kLightFeatures], of order one: log(1 + irradiance) by channel, indirect and direct; the
  /// spread of the points' light over its mean, the logarithm of their weight, how far the
  /// neighbours face the query's way, lie above its plane, and are brighter than those that count,
  /// and the logarithm of their distance. Where the light has errors, one column more: the standard
  /// error of its mean, over that mean.
  at::Tensor features;
};

/// The points that irradiance is read between, and the light on either side of them.
struct LightPrior {
  at::Tensor position;  ///< [S, 3] float32, network space
  at::Tensor normal;    ///< [S, 6] of front and back, the latter kPriorBack long
  at::Tensor light;     ///< [S, 12] of front and back: indirect, direct, over the emission scale
  at::Tensor error;     ///< [S, 2] relative standard error of indirect irradiance, or undefined
  at::Tensor floor;     ///< [3] added everywhere: kPriorFloor of the mean (lte/nn/constants.h)
  /// Over `position`, or null: then each read() on the CPU builds its own.
  std::shared_ptr<const ops::KnnIndex> nearest;

  bool defined() const { return position.defined(); }
  /// Inputs on one device, in one dtype; no gradients.
  LightReading read(const at::Tensor& position, const at::Tensor& normal) const;
  /// Makes `nearest` where there are points on the CPU.
  void make_index();
  std::vector<at::Tensor> tensors() const { return {position, normal, light, error, floor}; }
};

/// The prior of the points that do not emit: luminaires carry no light.
///
/// @param position  [M, 3] network space
/// @param normal    [M, 3]
/// @param emission  [M, 3]
/// @param light     [M, 12] of front and back: indirect, direct, over the emission scale
/// @param error     [M, 2] PointSet::indirect_error; may be undefined
LightPrior make_light_prior(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& emission, const at::Tensor& light,
                            const at::Tensor& error = {});

}  // namespace lte::nn
