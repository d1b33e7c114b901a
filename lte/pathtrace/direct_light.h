// Direct irradiance at many points with few shadow rays each: what pictures add to the network's
// indirect light.
//
// estimate_irradiance() takes paths of one point at a time, by light group. Here points share
// blocks, so that packets are full with one ray a point too, and groups are summed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/sample_number.h"

namespace lte::pathtrace {

/// Points that are asked for direct light. The spans are [points].
struct DirectPoints {
  std::span<const Vec3> positions, normals;  ///< normals are unit
  /// Random numbers of a point: distinct ones. Empty where `numbers` are given.
  std::span<const uint64_t> streams;
  /// Of the surfaces, where `normals` are shading normals: no light arrives from below them. Empty
  /// where they are the same.
  std::span<const Vec3> geometric_normals{};
  /// For samples that go on over several calls, in a point set a place and not one of the tile.
  /// The seed says nothing then.
  std::span<const SampleNumber> numbers{};
};

struct DirectOptions {
  uint64_t seed = 0;
  /// Rays over the hemisphere for each light sample, on average, in [0, 1]. Both are combined by
  /// the balance heuristic. They bound the noise near large lights, where light samples alone have
  /// no bound; elsewhere they cost more than they bring. 0 leaves them out.
  float hemisphere_share = 0.25f;
  /// Light samples are weighed as beside such rays, but none are traced: the caller has others that
  /// bring their part, as many as the share says.
  bool hemisphere_elsewhere = false;
  /// The samples of a point are cut into two halves, which are stratified apart, so that their
  /// difference tells the variance. Points with one sample have none. Not of DirectPoints::numbers.
  bool variance = false;
};

struct DirectLight {
  std::vector<Rgb> irradiance;  ///< [points], W/m²
  /// [points]: variance of the mean, of its luminance; infinite for a point with one sample. Empty
  /// unless asked for. From two halves it is itself known to 140 %: average it over points.
  std::vector<float> variance;
  int64_t rays_traced = 0;
};

/// Estimates E = ∫ L cosθ dω of what arrives straight from lights, in parallel. The result depends
/// neither on threads nor on which points are asked together.
/// @param samples  [points] light samples of each; a point with 0 has irradiance 0
/// @throws lte::Error if sizes differ, a value is not finite, or a count or the share is out of
///         range.
DirectLight estimate_direct(const Bvh& bvh, const Lights& lights, const DirectPoints& points,
                            std::span<const int32_t> samples, const DirectOptions& options);

}  // namespace lte::pathtrace
