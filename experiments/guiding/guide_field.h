// Guides all over a scene, for the diffuse vertices of a path: tables at places, each of which
// serves what is near it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "experiments/guiding/guide_table.h"
#include "experiments/guiding/shared_places.h"

namespace lte::experiments {

/// Paths draw by the cosine too, so that a table may lack directions and a vertex may lack a table.
class GuideField {
 public:
  /// @param tables          one for each place
  /// @param material_share  of draws by the cosine, in (0, 1)
  /// @param hits            of a path that are guided, the first ones; at least 1
  /// @throws lte::Error if there are not as many tables as places, or for another share or hits
  GuideField(SharedPlaces places, std::vector<std::shared_ptr<const GuideTable>> tables,
             float material_share, int hits = kAllHits);
  static constexpr int kAllHits = 1 << 20;

  /// The place that guides at a surface point, one of the nearest; kNone where none is near.
  /// @param position  world
  /// @note  A look at one entry of a table, which a path takes at each of its vertices.
  int32_t at(const Vec3& position, const Vec3& normal) const;

  /// By the cosine or by the table of a place.
  /// @param u  of the unit square  @return  world, unit; it may point below the surface
  Vec3 direction(int32_t place, const Vec3& normal, Vec2 u) const;

  /// Solid-angle density of direction(). @param cosine  of the direction, above 0
  float pdf(int32_t place, float cosine, const Vec3& direction) const;

  /// Of a path, the first ones, that are guided.
  int hits() const { return hits_; }

 private:
  /// A cube in space, half a radius wide, and the axis that normals there lie nearest to.
  struct Voxel {
    std::array<int32_t, 3> at;
    int32_t face;  ///< 0 to 5

    friend bool operator==(const Voxel&, const Voxel&) = default;
  };
  struct Entry {
    Voxel voxel;
    int32_t place;  ///< kNone in entries without a voxel
  };
  Voxel voxel_of(const Vec3& position, const Vec3& normal) const;
  /// The entry of a voxel, or the empty one that it may take.
  size_t entry_of(const Voxel& voxel) const;
  void fill();

  float width_;  ///< of a voxel, m
  SharedPlaces places_;
  std::vector<std::shared_ptr<const GuideTable>> tables_;
  float material_share_;
  int hits_;
  std::vector<Entry> entries_;  ///< a hash table with open addressing; a power of two of them
};

}  // namespace lte::experiments
