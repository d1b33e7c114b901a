// A regular grid of discs, and the rays that look for them.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::nn {

struct Surfel {
  Vec3 position, normal;  ///< unit normal
  float radius = 0;
  Rgb front, back, emission, metal;  ///< as the columns of Surfels
  float metallic = 0, roughness = 1;
};

/// What a ray sees.
struct Sight {
  Rgb radiance;
  float distance = 0, metallic = 0, cosine = 0;
  bool hit = false;
};

class SurfelGrid {
 public:
  SurfelGrid(std::vector<Surfel> surfels, bool total);

  /// Discs whose middle a ray meets at nearly the nearest distance share the answer, by how near
  /// their middles are. Metals reflect the ray, at most kBounces times.
  /// @param direction  unit
  Sight look(const Vec3& origin, const Vec3& direction) const { return look(origin, direction, 0); }

 private:
  struct Layer;

  Sight look(const Vec3& origin, const Vec3& direction, int bounce) const;
  Rgb reflected(const Layer& layer, const Vec3& direction, int bounce) const;
  /// What the ray meets first, blended.
  bool meet(const Vec3& origin, const Vec3& direction, Layer* layer) const;
  void fill_cells();

  std::vector<Surfel> surfels_;
  bool total_;
  Rgb ambient_;  ///< mean of what all discs send out, where a reflection meets none
  Vec3 low_;
  float cell_ = 1;
  int size_[3] = {1, 1, 1};
  std::vector<int32_t> first_, member_;  ///< discs by cell
};

}  // namespace lte::nn
