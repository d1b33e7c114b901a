// Small places that send out much of what a scene's surfaces reflect: a patch of sun, the wall
// beside a lamp, the inside of a shade. Rays by the cosine meet them rarely. A gather aims a share
// of its rays at them, and weighs all rays by the density of both together (Veach and Guibas 1995,
// the balance heuristic with one sample), so that what they bring stays what it is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/cache_records.h"

namespace lte::gi {

/// How the rays of one point are aimed: by the cosine, or within cones around bright places.
class Aim {
 public:
  static constexpr int kMax = 8;

  /// Of the rays, that are aimed at bright places.
  float share() const { return share_; }
  /// A direction for `u` in [0, 1)², which may point below the surface. @param normal  unit
  Vec3 sample(const Vec3& normal, const Vec2& u) const;
  /// Solid-angle density of sample(). @param cosine  of the direction to the normal
  float pdf(float cosine, const Vec3& direction) const;

 private:
  friend class BrightPlaces;
  struct Cone {
    Vec3 axis;
    float least_cosine;
    float weight;  ///< those of all cones sum up to share_
  };
  float share_ = 0;
  int count_ = 0;
  std::array<Cone, kMax> cones_;
};

/// Of one light on the records of a cache. Thread-safe.
class BrightPlaces {
 public:
  BrightPlaces() = default;
  /// @param irradiance  total at the records, [records.size()]
  BrightPlaces(const CacheRecords& records, std::span<const Rgb> irradiance);

  bool empty() const { return places_.empty(); }
  /// For a point of a surface. Nothing is known of what stands between.
  Aim aim(const Vec3& position, const Vec3& normal) const;

 private:
  struct Place {
    Vec3 position, normal;
    float radius2 = 0;    ///< of a disc, m²
    float intensity = 0;  ///< along the normal, W/sr, summed over channels
  };

  float join_neighbors(const CacheRecords& records, const std::vector<float>& radiance,
                       std::vector<uint32_t>* left);

  std::vector<Place> places_;
  float elsewhere_ = 0;  ///< irradiance by the mean radiance of all other surfaces, W/m²
};

}  // namespace lte::gi
