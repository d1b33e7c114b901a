#include "lte/scene/inspect/inspect.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "lte/base/parallel_each.h"
#include "lte/scene/inspect/buckets.h"
#include "lte/scene/inspect/shells.h"
#include "lte/scene/inspect/topology.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

/// Height over longest edge below which a triangle has no normal in float.
constexpr double kThin = 1e-7;
constexpr int64_t kThinGrain = 65536;

const Material& material_of(const Scene& scene, const PlacedTriangle& t) {
  const Mesh& mesh =
      scene.meshes[static_cast<size_t>(scene.instances[static_cast<size_t>(t.instance)].mesh)];
  return scene.materials[static_cast<size_t>(mesh.material)];
}

bool is_degenerate(const Scene& scene, const PlacedTriangle& t) {
  const Instance& instance = scene.instances[static_cast<size_t>(t.instance)];
  const WorldTriangle w = world_triangle(scene.meshes[static_cast<size_t>(instance.mesh)],
                                         instance.to_world, t.triangle);
  double longest = 0;  // squared
  for (const auto& [a, b] : {std::pair(w.p0, w.p1), std::pair(w.p1, w.p2), std::pair(w.p2, w.p0)}) {
    const double x = double{b.x} - a.x, y = double{b.y} - a.y, z = double{b.z} - a.z;
    longest = std::max(longest, x * x + y * y + z * z);
  }
  return !(area_vector(w).norm() > kThin * longest);
}

std::array<uint32_t, 3> sorted(std::array<uint32_t, 3> place) {
  std::sort(place.begin(), place.end());
  return place;
}

/// Whether the corners are in the rising order of places, up to rotation.
bool is_even(const std::array<uint32_t, 3>& p) {
  return (p[0] < p[1]) + (p[1] < p[2]) + (p[2] < p[0]) == 2;
}

/// Counts the faults of every triangle once, and marks those that edges and shells leave out.
class Inspection {
 public:
  Inspection(const Scene& scene, double tolerance)
      : scene_(scene),
        topology_(build_topology(scene, tolerance)),
        covered_(topology_.triangles.size()) {
    faults_.near_duplicate_vertices = topology_.near_duplicates;
    find_degenerate();
    find_coincident();
    count_shells(topology_, covered_, &faults_);
  }

  const GeometryFaults& faults() const { return faults_; }

 private:
  /// Marks triangles without area. Those with two corners in one place are left out of edges and
  /// shells, but count as degenerate only if they are thin.
  void find_degenerate() {
    std::vector<uint8_t> thin(topology_.triangles.size());
    parallel_each(thin.size(), kThinGrain, [&](size_t i) {
      thin[i] = is_degenerate(scene_, topology_.triangles[i]) ? 1 : 0;
    });
    for (size_t i = 0; i < thin.size(); ++i) {
      const auto& [a, b, c] = topology_.triangles[i].place;
      covered_[i] = a == b || b == c || c == a;
      if (thin[i] == 0) continue;
      ++faults_.degenerate_triangles;
      covered_[i] = true;
    }
  }

  void find_coincident() {
    struct Corners {
      uint32_t middle, high, triangle;
      auto operator<=>(const Corners&) const = default;
      bool same_place(const Corners& b) const { return middle == b.middle && high == b.high; }
    };
    Buckets<Corners> by_lowest(topology_.places.size(), [&](const auto& use) {
      for (uint32_t i = 0; i < covered_.size(); ++i) {
        if (covered_[i]) continue;
        const auto [low, middle, high] = sorted(topology_.triangles[i].place);
        use(low, {middle, high, i});
      }
    });
    by_lowest.for_each([](std::span<Corners> bucket) { std::sort(bucket.begin(), bucket.end()); });
    for (size_t low = 0; low < by_lowest.size(); ++low) {
      const std::span<const Corners> all = by_lowest[low];
      for (size_t first = 0, k = 0; k < all.size(); ++k) {
        if (!all[k].same_place(all[first])) first = k;
        if (k > first) classify_coincident(all[first].triangle, all[k].triangle);
      }
    }
  }

  /// Counts a pair of triangles in one place. `duplicate` lies on `first`, which comes before it in
  /// the scene.
  void classify_coincident(uint32_t first, uint32_t duplicate) {
    const PlacedTriangle &a = topology_.triangles[first], &b = topology_.triangles[duplicate];
    const Material &one = material_of(scene_, a), &other = material_of(scene_, b);
    covered_[duplicate] = true;
    const bool same_winding = is_even(a.place) == is_even(b.place);
    if (&one != &other) {
      ++faults_.conflicting_triangles;
    } else if (same_winding) {
      ++faults_.duplicate_triangles;
    } else {
      ++faults_.opposite_triangles;
    }
  }

  const Scene& scene_;
  WorldTopology topology_;
  std::vector<bool> covered_;
  GeometryFaults faults_;
};

}  // namespace

GeometryFaults inspect(const Scene& scene, double tolerance) {
  GeometryFaults faults;
  faults.inspected = scene.triangle_count() <= kMaxInspected;
  return faults.inspected ? Inspection(scene, tolerance).faults() : faults;
}

}  // namespace lte::scene
