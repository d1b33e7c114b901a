// What surfaces send out, kept at points of a scene: a cache that rays read where they would
// otherwise become longer paths.
//
// The table keeps irradiance and not radiosity: a reader multiplies by the albedo of its own hit,
// whose texture is finer than any table. Entries belong to one side of a surface; both sides of a
// wall are two.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/surface_index.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::gi {

/// Where a table knows the light, one entry a side of a point.
struct TableEntries {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<float> area;  ///< m² that the entry stands for

  int64_t size() const { return static_cast<int64_t>(position.size()); }
  /// Those with keep[i] != 0.
  TableEntries kept(std::span<const uint8_t> keep) const;
};

/// Draws points by area, a tenth of them on luminaires at least, and makes two entries of each:
/// `count` in all, or one more.
TableEntries sample_entries(const scene::Scene& scene, int64_t count, uint64_t seed);

/// Light at entries, summed over light groups, W/m².
struct EntryLight {
  std::vector<Rgb> direct;    ///< depth 1
  std::vector<Rgb> indirect;  ///< depths 2 to max_depth
  int64_t rays_traced = 0;

  std::vector<Rgb> total() const;
};

/// Path-traced estimates. With max_depth 1 `indirect` is 0.
/// @param paths  of each entry
EntryLight estimate_entries(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                            const TableEntries& entries, int paths, int max_depth, uint64_t seed);

/// 1 for the entries that any light was found at: of both sides of a closed wall's points one.
std::vector<uint8_t> lit(const EntryLight& light);

struct TableOptions {
  /// How far an entry speaks for its surroundings, in the edges of the square that it stands for.
  float radius = 1.5f;
  /// Least sum of weights for an answer; a single entry at its own place has 1.
  float least_weight = 0.4f;
};

/// Irradiance at any place of the surfaces, interpolated between entries. Thread-safe.
class RadiosityTable {
 public:
  /// @param irradiance  total (direct and indirect) at the entries
  /// @throws lte::Error if sizes differ or a value is not finite.
  RadiosityTable(const pathtrace::Bvh& bvh, const TableEntries& entries,
                 std::vector<Rgb> irradiance, const TableOptions& options = {});

  /// Irradiance on the side `normal` of the surface at `position`.
  /// @return  false where no entries near enough stand on the same side, in sight along the surface
  bool lookup(const Vec3& position, const Vec3& normal, Rgb* irradiance) const;

  int64_t size() const { return index_.size(); }
  /// Mean radius of the entries, metres.
  float radius() const { return radius_; }

 private:
  /// What stands on the surface around an entry, by octant around its normal: a wall on a floor
  /// ends what the floor on this side of it has to say.
  struct Walls {
    Vec3 tangent, bitangent;
    /// Places beyond the wall have (x, y) · normal > distance. A zero normal stands for no wall.
    struct Plane {
      float x = 0, y = 0, distance = 0;
    };
    std::array<Plane, 8> plane;

    bool hides(const Vec3& offset) const;
  };
  static constexpr uint32_t kNone = ~0u;
  /// @return  whether there are any within `radius`
  static bool find_walls(const pathtrace::Bvh& bvh, const Vec3& position, const Vec3& normal,
                         float radius, Walls* walls);

  struct Entry {
    Rgb irradiance;
    uint32_t walls = kNone;  ///< index into walls_
  };
  SurfaceIndex index_;
  std::vector<Entry> entries_;
  std::vector<Walls> walls_;
  float radius_ = 0, least_weight_ = 0;
};

}  // namespace lte::gi
