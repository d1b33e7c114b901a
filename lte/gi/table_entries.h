// Places that a table of light knows, and path-traced light at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::gi {

/// Where a table knows the light, one entry a side of a place.
///
/// An entry's light is the mean over points of the surface around it: a small bright patch then
/// counts by its area, whether or not an entry stands in it.
struct TableEntries {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<float> area;                ///< m² that the entry stands for
  std::vector<Vec3> start, start_normal;  ///< points, those of entry after entry
  std::vector<size_t> first{0};           ///< [size() + 1]: an entry's first point, and their end

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  /// Adds an entry of one point.
  void add(const Vec3& position, const Vec3& normal, const Rgb& albedo, float area);
};

/// Points of an entry at most.
inline constexpr int kEntryPoints = 4;

/// Draws points by area, a tenth of them on luminaires at least, joins neighbours that lie in one
/// plane and see each other along it, and makes two entries of what they are then: `count` where
/// surfaces are level, up to kEntryPoints times as many of smaller areas where they are not.
TableEntries sample_entries(const pathtrace::Bvh& bvh, int64_t count, uint64_t seed);

/// Light at entries, summed over light groups, W/m².
struct EntryLight {
  std::vector<Rgb> direct;    ///< depth 1
  std::vector<Rgb> indirect;  ///< depths 2 to max_depth
  int64_t rays_traced = 0;

  std::vector<Rgb> total() const;
};

/// Of values at all points of the entries, [entries.start], the mean over those of each.
std::vector<Rgb> entry_means(const TableEntries& entries, std::span<const Rgb> of_point);

/// Path-traced estimates. With max_depth 1 `indirect` is 0. Where paths find nothing light is 0,
/// and that counts: a table of the others alone would be too bright where light is rare.
/// @param paths  of an entry of kEntryPoints points; each point has its share, at least one
EntryLight estimate_entries(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const TableEntries& entries, int paths, int max_depth, uint64_t seed);

}  // namespace lte::gi
