// What surfaces send out, kept at points of a scene: a cache that rays read where they would
// otherwise become longer paths.
//
// The cache keeps irradiance and not radiosity: a reader multiplies by the albedo of its own hit,
// whose texture is finer than any cache. Records belong to one side of a surface; both sides of a
// wall are two.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/bright_places.h"
#include "lte/gi/cache_records.h"
#include "lte/gi/near_lamps.h"
#include "lte/gi/surface_index.h"
#include "lte/pathtrace/bvh.h"

namespace lte::gi {

struct CacheOptions {
  /// How far a record speaks for its surroundings, in the edges of the square that it stands for.
  float radius = 1.5f;
  /// Least sum of weights for an answer; a single record at its own place has 1.
  float least_weight = 0.4f;
  /// Standard deviation of direct irradiance between the records around a place beyond which the
  /// cache does not know the light there, over their mean total irradiance: smoothing would carry
  /// light past edges of shadows, gaps and walls. Paths go on there without bias. Noise of the
  /// records is no such difference: its variance is taken off.
  float uneven = 0.35f;
  /// Added to that bound, over the mean total irradiance of all lit records by area.
  float even_below = 0.05f;
  /// Nearer than so many mean radii to a small lamp the cache does not know the light (NearLamps).
  float near_lamps = 0.5f;
};

/// Irradiance at any place of the surfaces, interpolated between records. Thread-safe.
class IrradianceCache {
 public:
  /// @param irradiance  total (direct and indirect) at the records
  /// @param direct      its direct part; empty where light is taken to be even everywhere. What is
  ///                    indirect does not decide: noise of paths would then choose what they say.
  /// @param direct_variance  RecordLight::direct_variance; empty where direct light is exact
  /// @param shorter  `irradiance` without the light of its last bounce, for paths that come there
  ///                 one bounce later; empty: the same
  /// @throws lte::Error if sizes differ or a value is not finite.
  IrradianceCache(const pathtrace::Bvh& bvh, const CacheRecords& records,
                  std::span<const Rgb> irradiance, std::span<const Rgb> direct = {},
                  std::span<const float> direct_variance = {}, std::span<const Rgb> shorter = {},
                  const CacheOptions& options = {});
  /// Of traced light.
  static IrradianceCache of(const pathtrace::Bvh& bvh, const CacheRecords& records,
                            const RecordLight& light);

  /// The same records and direct light with other light in all, for a fraction of what making a
  /// cache takes. Both share what they know of the places.
  /// @param records  those that the cache was made of
  /// @param shorter  as above
  IrradianceCache relit(const CacheRecords& records, std::span<const Rgb> irradiance,
                        std::span<const Rgb> shorter = {}) const;
  /// With other light in the answers of lookup(), which it gives for the same places as this one:
  /// a gather then is linear in the light.
  IrradianceCache answering(std::span<const Rgb> irradiance) const;

  /// Irradiance on the side `normal` of the surface at `position`.
  /// @param hit  which one of a path from a point it is; those after the first read light of one
  ///             bounce less
  /// @return  false where no records near enough stand on the same side, in sight along the
  ///          surface, and where these differ by more than CacheOptions::uneven
  bool lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance, int hit = 1) const;

  /// Where rays that read the cache should be aimed.
  const BrightPlaces& bright_places() const { return bright_; }

  int64_t size() const { return static_cast<int64_t>(records_.size()); }
  /// Whether a record says nothing, as no lit one leads to it along surfaces.
  bool silent(int64_t record) const { return records_[static_cast<size_t>(record)].silent; }
  /// How much a record counts in the mean of those around a place, for how far one sees from it.
  float share(int64_t record) const { return records_[static_cast<size_t>(record)].share; }
  /// Mean radius of the records, metres.
  float radius() const { return places_->radius; }

 private:
  /// What stands on the surface around a record, by octant around its normal: a wall on a floor
  /// ends what the floor on this side of it has to say.
  struct Walls {
    Vec3 normal, tangent, bitangent;
    /// Places beyond the wall have (x, y) · normal > distance. A zero normal stands for no wall.
    struct Plane {
      float x = 0, y = 0, distance = 0;
    };
    std::array<Plane, 8> plane;
    /// How far along the normal, and against it, the next sheet is.
    float above = INFINITY, below = INFINITY;

    bool hides(const Vec3& offset) const;
  };
  static constexpr uint32_t kNone = ~0u;
  /// @param open  gets how far one sees from there, in radii, at most 1: the geometric mean of that
  ///              along the surface, over all octants, and of that away from it
  /// @return      whether there are any walls within `radius`
  static bool find_walls(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal,
                         float radius, Walls* walls, float* open);

  /// What caches of the same records with other light share.
  struct Places {
    NearLamps lamps;
    SurfaceIndex index;
    std::vector<Walls> walls;
    float radius = 0;  ///< mean
  };

  void set_light(const CacheRecords& records, std::span<const Rgb> irradiance,
                 std::span<const Rgb> shorter);
  bool speaks(uint32_t record, const Vec3& offset) const;
  void silence_dark_sheets(const CacheRecords& records);

  struct Record {
    Rgb irradiance;
    Rgb shorter;                  ///< without the light of its last bounce
    float total = 0, direct = 0;  ///< sums over the channels, of all light and of direct light
    float noise = 0;              ///< variance of `direct`
    float share = 1;              ///< of what its weight would be in the open
    uint32_t walls = kNone;       ///< index into Places::walls
    bool silent = false;          ///< says nothing
  };
  std::shared_ptr<const Places> places_;
  BrightPlaces bright_;
  std::vector<Record> records_;
  CacheOptions options_;
  float even_below_ = 0;  ///< CacheOptions::even_below of this light, W/m²
};

}  // namespace lte::gi
