// Places on surfaces that stand for what is near them and faces the same way, so that what is dear
// to make at a point (a map of radiance) is made at few.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lte/base/math.h"

namespace lte::experiments {

/// Points join the nearest place that is near enough, or become places themselves: leader
/// clustering (Hartigan, Clustering Algorithms, 1975), in the order in which they come.
class SharedPlaces {
 public:
  /// @param radius_m      a point is no further from its place
  /// @param least_cosine  between their normals
  /// @throws lte::Error unless the radius is positive and finite and the cosine in [-1, 1]
  SharedPlaces(float radius_m, float least_cosine);

  /// The nearest place that a point may join; -1 without one. The first of equally near ones.
  int32_t find(const Vec3& position, const Vec3& normal) const;

  /// The same, where a point without one becomes a place.
  int32_t join(const Vec3& position, const Vec3& normal);

  float radius() const { return radius_; }
  const std::vector<Vec3>& position() const { return position_; }
  const std::vector<Vec3>& normal() const { return normal_; }

 private:
  using Cell = std::array<int32_t, 3>;
  struct CellHash {
    size_t operator()(const Cell& cell) const;
  };
  int32_t column(float x) const;

  float radius_, least_cosine_;
  std::vector<Vec3> position_, normal_;
  /// Places by the cell, two radii wide, that they lie in.
  std::unordered_map<Cell, std::vector<int32_t>, CellHash> cells_;
};

}  // namespace lte::experiments
