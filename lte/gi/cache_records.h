// Places that a cache of light knows, and path-traced light at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::gi {

/// Where a cache knows the light, one record a side of a place.
///
/// A record's light is the mean over points of the surface around it: a small bright patch then
/// counts by its area, whether or not a record stands in it.
struct CacheRecords {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<float> area;                ///< m² that the record stands for
  std::vector<Vec3> start, start_normal;  ///< points, those of record after record
  std::vector<Vec3> start_shading;        ///< their shading normals; empty where no map bends any
  std::vector<size_t> first{0};           ///< [size() + 1]: a record's first point, and their end

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  /// Adds a record of one point.
  void add(const Vec3& position, const Vec3& normal, const Rgb& albedo, float area);
};

/// Points of a record at most.
inline constexpr int kRecordPoints = 4;

/// Draws points by area, a tenth of them on luminaires at least, joins neighbours that lie in one
/// plane, see each other along it and have as much room above them, and makes two records of what
/// they are then: `count` where surfaces are level, up to kRecordPoints times as many of smaller
/// areas where they are not.
CacheRecords sample_records(const pathtrace::Bvh& bvh, int64_t count, uint64_t seed);

/// Light at records, summed over light groups, W/m².
struct RecordLight {
  std::vector<Rgb> direct;    ///< depth 1
  std::vector<Rgb> indirect;  ///< depths 2 to max_depth
  std::vector<Rgb> last;      ///< of that max_depth alone; empty where nobody knows
  /// Variance of `direct`, summed over its channels, as far as it is of light samples; empty where
  /// points have one each. A record's own is known to 140 %: average it over some.
  std::vector<float> direct_variance;
  int64_t rays_traced = 0;

  std::vector<Rgb> total() const;
  /// total() without the light of its last bounce; empty where nobody knows it.
  std::vector<Rgb> shorter() const;
};

/// Of values at all points of the records, [records.start], the mean over those of each.
std::vector<Rgb> record_means(const CacheRecords& records, std::span<const Rgb> of_point);

/// Path-traced estimates. With max_depth 1 `indirect` is 0. Where paths find nothing light is 0,
/// and that counts: a cache of the others alone would be too bright where light is rare.
/// @param paths  of a record of kRecordPoints points; each point has its share, at least one
RecordLight estimate_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const CacheRecords& records, int paths, int max_depth, uint64_t seed);

}  // namespace lte::gi
