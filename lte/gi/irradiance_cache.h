// What surfaces send out, kept at points of a scene: a cache that rays read where they would
// otherwise become longer paths.
//
// The cache keeps irradiance and not radiosity: a reader multiplies by the albedo of its own hit,
// whose texture is finer than any cache. Records belong to one side of a surface; both sides of a
// wall are two.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/bright_places.h"
#include "lte/gi/cache_geometry.h"
#include "lte/gi/cache_records.h"
#include "lte/pathtrace/bvh.h"

namespace lte::gi {

/// Irradiance at any place of the surfaces, interpolated between records. Thread-safe.
class IrradianceCache {
 public:
  /// @param geometry    of these records; caches of the same share it
  /// @param irradiance  total (direct and indirect) at the records
  /// @param direct      its direct part; empty where light is taken to be even everywhere. What is
  ///                    indirect does not decide: noise of paths would then choose what they say.
  /// @param direct_variance  RecordLight::direct_variance; empty where direct light is exact
  /// @param shorter  `irradiance` without the light of its last bounce, for paths that come there
  ///                 one bounce later; empty: the same
  /// @throws lte::Error if sizes differ or a value is not finite.
  IrradianceCache(std::shared_ptr<const CacheGeometry> geometry, const CacheRecords& records,
                  std::span<const Rgb> irradiance, std::span<const Rgb> direct = {},
                  std::span<const float> direct_variance = {}, std::span<const Rgb> shorter = {});
  IrradianceCache(const pathtrace::Bvh& bvh, const CacheRecords& records,
                  std::span<const Rgb> irradiance, std::span<const Rgb> direct = {},
                  std::span<const float> direct_variance = {}, std::span<const Rgb> shorter = {});
  /// Of traced light.
  static IrradianceCache of(std::shared_ptr<const CacheGeometry> geometry,
                            const CacheRecords& records, const RecordLight& light);

  /// The same records and direct light with other light in all, for a fraction of what making a
  /// cache takes.
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
  ///          surface, and where their direct light differs by more than smooth light would
  bool lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance, int hit = 1) const;

  /// Where rays that read the cache should be aimed.
  const BrightPlaces& bright_places() const { return bright_; }

  int64_t size() const { return static_cast<int64_t>(records_.size()); }
  /// Whether a record says nothing, as no lit one leads to it along surfaces.
  bool silent(int64_t record) const { return records_[static_cast<size_t>(record)].silent; }
  /// Mean radius of the records, metres.
  float radius() const { return geometry_->radius(); }

 private:
  void set_light(const CacheRecords& records, std::span<const Rgb> irradiance,
                 std::span<const Rgb> shorter);

  struct Record {
    Rgb irradiance;
    Rgb shorter;                  ///< without the light of its last bounce
    float total = 0, direct = 0;  ///< sums over the channels, of all light and of direct light
    float noise = 0;              ///< variance of `direct`
    bool silent = false;          ///< says nothing
  };
  std::shared_ptr<const CacheGeometry> geometry_;
  BrightPlaces bright_;
  std::vector<Record> records_;
  float even_below_ = 0;  ///< differences of direct light up to it count as even, W/m²
};

}  // namespace lte::gi
