// Noisy irradiance at scene points, read between them as irradiance caching does: a mean over near
// points that face the query's way and lie in its plane (Ward et al. 1988, "A Ray Tracing Solution
// for Diffuse Interreflection", and the normal and plane weights of edge-avoiding filters). It
// starts the network off near the answer; the network corrects what it blurs.
#pragma once

#include <cstdint>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/nn/config.h"

namespace lte::nn {

/// What a query reads.
struct LightReading {
  /// [Q, 3], positive where the scene has bounced light in that channel; 1 without any point.
  at::Tensor irradiance;
  /// [Q, kLightFeatures], of order one: log(1 + irradiance) by channel, indirect and direct; the
  /// spread of the estimates over their mean, the logarithm of their weight, how far the neighbours
  /// face the query's way, lie above its plane, and are brighter than those that count, and the
  /// logarithm of their distance. Where the estimates have errors, one column more: the standard
  /// error of their mean, over that mean.
  at::Tensor features;
};

/// The points that irradiance is read between, and theirs.
struct LightCache {
  at::Tensor position;  ///< [S, 3] float32, network space
  at::Tensor normal;    ///< [S, 3 sides]; that of a back is kCacheBack long
  at::Tensor light;     ///< [S, 6 sides] indirect and direct irradiance over the emission scale
  at::Tensor error;     ///< [S, sides] relative standard error of indirect irradiance, or undefined
  at::Tensor floor;     ///< [3] added everywhere: kCacheFloor of the mean (lte/nn/constants.h)

  bool defined() const { return position.defined(); }
  int64_t sides() const { return normal.size(1) / 3; }  ///< of each point
  /// Inputs on one device, in one dtype; no gradients.
  LightReading read(const at::Tensor& position, const at::Tensor& normal) const;
  std::vector<at::Tensor> tensors() const { return {position, normal, light, error, floor}; }
};

/// A cache of the points that do not emit: luminaires carry no estimate.
///
/// @param position  [M, 3] network space
/// @param normal    [M, 3]
/// @param emission  [M, 3]
/// @param light     [M, 6] indirect and direct irradiance over the emission scale, or [M, 12] that
///                  of the front and then that of the back
/// @param error     [M, sides] PointSet::indirect_error; may be undefined
LightCache make_light_cache(const at::Tensor& position, const at::Tensor& normal,
                            const at::Tensor& emission, const at::Tensor& light,
                            const at::Tensor& error = {});

}  // namespace lte::nn
