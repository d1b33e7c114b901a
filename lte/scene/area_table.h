// Prefix sums of triangle areas: from a fraction of the area to the triangle there.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lte/scene/repeated_triangles.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// One side of an instance's surface.
struct Face {
  int instance = 0;
  bool back = false;
  friend bool operator<(const Face& a, const Face& b) {
    return std::pair(a.instance, a.back) < std::pair(b.instance, b.back);
  }
};

/// The fronts of instances.
std::vector<Face> fronts(std::span<const int> instances);
/// The faces of instances that emit light, and the fronts of the others: an emissive material that
/// is double-sided has two.
std::vector<Face> emitting_faces(const Scene& scene, std::span<const int> instances);

/// The triangles of some faces of a scene in a row, in order. It keeps no reference to the scene.
class AreaTable {
 public:
  struct Place {
    Face face;
    uint32_t triangle = 0;
    double fraction = 0;  ///< of the triangle's area that lies before the place, [0, 1)
  };

  /// @param repeated  triangles that count as having no area; null for none
  AreaTable(const Scene& scene, std::vector<Face> faces,
            const RepeatedTriangles* repeated = nullptr);

  /// Area of all triangles in m², summed in double.
  double total() const { return ends_.empty() ? 0.0 : ends_.back(); }

  /// The place that has area `target` before it, for a target in [0, total()). It is never in a
  /// triangle without area.
  Place locate(double target) const;

 private:
  std::vector<Face> faces_;
  std::vector<int64_t> first_;  ///< index of each face's first triangle, then their number
  std::vector<double> ends_;    ///< area up to and with each triangle
  int64_t last_ = 0;            ///< last triangle that has area
};

}  // namespace lte::scene
