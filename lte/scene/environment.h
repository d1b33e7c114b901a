// Light from all around: a constant radiance, or a picture of the whole sphere of directions.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "lte/base/math.h"
#include "lte/image/image.h"

namespace lte::scene {

/// How a picture covers the sphere, in the environment's own frame.
enum class SphereMapping {
  /// Longitude and latitude, Y up: row 0 at +Y, the middle of the picture at +X, +Z a quarter of
  /// its width to the right of that. What Blender's exporter and three.js take a panorama for.
  Equirectangular,
  /// The octahedral map of equal areas of Clarberg (Fast equal-area mapping of the (hemi)sphere
  /// using SIMD, 2008) that pbrt-v4 has for image lights: a square, +Z in its middle, −Z in its
  /// corners.
  EqualArea,
};

/// Clarberg's map of the unit square to directions, (0, 0) in the top left corner.
Vec3 equal_area_direction(double u, double v);
/// The inverse of equal_area_direction(); `direction` is unit.
Vec2 equal_area_point(const Vec3& direction);

/// Radiance by direction, constant over each texel: what is sampled is then exactly what is seen.
class EnvironmentMap {
 public:
  /// Texels that one picture may have.
  static constexpr int64_t kMaxTexels = int64_t{1} << 26;

  /// @throws lte::Error unless `radiance` has 1 or more than 2 channels (alpha is dropped) whose
  /// values are finite and not negative, and is square for SphereMapping::EqualArea.
  EnvironmentMap(const image::Image& radiance, SphereMapping mapping);

  int width() const { return width_; }
  int height() const { return height_; }
  SphereMapping mapping() const { return mapping_; }

  /// @param direction  unit, in the environment's frame
  const Rgb& radiance(const Vec3& direction) const { return texels_[index(direction)]; }
  const Rgb& texel(size_t index) const { return texels_[index]; }
  /// Row-major number of the texel that a direction lies in.
  size_t index(const Vec3& direction) const;
  /// The direction at `within`, [0, 1]², of texel (x, y). Equal areas of `within` are equal solid
  /// angles.
  Vec3 direction(int x, int y, const Vec2& within) const;
  /// Solid angle of each texel of row `y`, in sr.
  double solid_angle(int y) const {
    return mapping_ == SphereMapping::EqualArea
               ? 4 * M_PI / (double{1} * width_ * height_)
               : 2 * M_PI / width_ *
                     (cosines_[static_cast<size_t>(y)] - cosines_[static_cast<size_t>(y) + 1]);
  }

 private:
  int width_ = 0, height_ = 0;
  SphereMapping mapping_;
  std::vector<Rgb> texels_;  ///< [height, width]
  /// [height + 1], the cosines of the rows' edges; empty unless the picture is equirectangular.
  std::vector<double> cosines_;
};

/// The environment of a scene. Light that leaves the scene in a direction meets its radiance there.
struct Environment {
  Rgb radiance{0, 0, 0};                      ///< of all directions, or the factor of `map`
  std::shared_ptr<const EnvironmentMap> map;  ///< null for a constant
  /// The axes of the environment's frame in the world: orthonormal, left-handed if mirrored.
  std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  int light_group = -1;  ///< that of the environment alone

  Vec3 to_local(const Vec3& world) const {
    return {dot(axes[0], world), dot(axes[1], world), dot(axes[2], world)};
  }
  Vec3 to_world(const Vec3& local) const {
    return axes[0] * local.x + axes[1] * local.y + axes[2] * local.z;
  }
  /// @param direction  unit, in the world, away from the scene
  Rgb radiance_from(const Vec3& direction) const {
    return map ? radiance * map->radiance(to_local(direction)) : radiance;
  }
};

/// The environment's fluence, ∫ L dω over all directions, in W m⁻².
Rgb fluence(const Environment& environment);

}  // namespace lte::scene
