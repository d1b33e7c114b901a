// Draws directions of an environment: a picture's by luminance times solid angle, texel by texel; a
// constant one's by the cosine to the surface.
#pragma once

#include <vector>

#include "lte/base/math.h"
#include "lte/scene/environment.h"

namespace lte::pathtrace {

/// Radiance that arrives from a direction, and the density of having drawn it.
struct EnvironmentSample {
  Vec3 direction;  ///< unit, world, away from the scene
  Rgb radiance;
  float pdf = 0;  ///< per solid angle; 0 if nothing arrives
};

/// Copies what it needs; the picture is shared. Thread-safe.
class EnvironmentSampler {
 public:
  /// Black: never draws anything.
  EnvironmentSampler() = default;
  explicit EnvironmentSampler(const scene::Environment& environment);

  bool black() const { return !(luminance_ > 0); }
  int light_group() const { return environment_.light_group; }
  /// ∫ luminance dω.
  double luminance() const { return luminance_; }

  /// @param normal  unit, of the side that light is to arrive on; zero for either
  EnvironmentSample sample(const Vec3& normal, const Vec2& u) const;
  /// What arrives from a unit direction, and the density with which sample(normal) draws it.
  EnvironmentSample evaluate(const Vec3& normal, const Vec3& direction) const;

 private:
  float texel_pdf(const Rgb& texel) const;

  scene::Environment environment_;
  double luminance_ = 0;
  /// For a picture: running sums of the rows' shares, and in each row of its texels' shares.
  /// Two-dimensional inversion keeps what is stratified in u stratified on the sphere.
  std::vector<double> rows_;
  std::vector<float> columns_;
};

}  // namespace lte::pathtrace
