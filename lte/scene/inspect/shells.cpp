#include "lte/scene/inspect/shells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/scene/inspect/buckets.h"
#include "lte/scene/inspect/disjoint_sets.h"

namespace lte::scene {
namespace {

/// An edge of a triangle, from the place whose bucket it is in to a higher one, and whether the
/// triangle passes it that way.
struct Edge {
  uint32_t high;
  uint32_t triangle : 31;
  uint32_t rising : 1;
};
static_assert(kMaxInspected < int64_t{1} << 31, "triangles are numbered in 31 bits");

/// The edges of each place to higher ones, in rising order of these and of triangles.
Buckets<Edge> sorted_edges(const WorldTopology& topology, const std::vector<bool>& covered) {
  Buckets<Edge> edges(topology.places.size(), [&](const auto& use) {
    for (uint32_t i = 0; i < topology.triangles.size(); ++i) {
      if (covered[i]) continue;
      const auto& place = topology.triangles[i].place;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = place[k], b = place[(k + 1) % 3];
        use(std::min(a, b), {std::max(a, b), i, a < b});
      }
    }
  });
  edges.for_each([](std::span<Edge> bucket) {
    std::sort(bucket.begin(), bucket.end(), [](const Edge& a, const Edge& b) {
      return std::pair(a.high, a.triangle) < std::pair(b.high, b.triangle);
    });
  });
  return edges;
}

/// Six times the volume under a triangle, seen from `origin`.
double volume(const WorldTopology& topology, const PlacedTriangle& t, const Vec3& origin) {
  std::array<std::array<double, 3>, 3> p;
  for (size_t k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c)
      p[k][static_cast<size_t>(c)] = double{topology.places[t.place[k]][c]} - origin[c];
  }
  return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
         p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
         p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
}

}  // namespace

void count_shells(const WorldTopology& topology, const std::vector<bool>& covered,
                  GeometryFaults* report) {
  DisjointSets sets(topology.triangles.size());          // connected by edges
  std::vector<bool> spoiled(topology.triangles.size());  // a triangle of no closed shell
  {
    Buckets<Edge> places = sorted_edges(topology, covered);
    for (size_t low = 0; low < places.size(); ++low) {
      const std::span<const Edge> edges = places[low];
      for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        size_t rising = 0;
        for (; end < edges.size() && edges[end].high == edges[begin].high; ++end) {
          rising += edges[end].rising;
          sets.join(edges[begin].triangle, edges[end].triangle);
        }
        const size_t count = end - begin;
        const Edge& edge = edges[begin];
        if (count == 1) {
          ++report->open_edges;
          report->open_edge_length_m += length(topology.places[edge.high] - topology.places[low]);
        }
        if (count > 2) ++report->branching_edges;
        if (count == 2 && rising != 1) ++report->flipped_edges;
        if (count != 2 || rising != 1) spoiled[edge.triangle] = true;
      }
    }
  }
  std::vector<double> volumes(topology.triangles.size());
  for (uint32_t i = 0; i < topology.triangles.size(); ++i) {
    if (covered[i]) continue;
    const uint32_t root = sets.root(i);
    if (spoiled[i]) spoiled[root] = true;
    volumes[root] +=
        volume(topology, topology.triangles[i], topology.places[topology.triangles[root].place[0]]);
  }
  for (uint32_t i = 0; i < topology.triangles.size(); ++i) {
    if (covered[i] || sets.root(i) != i || spoiled[i]) continue;
    ++report->closed_shells;
    if (volumes[i] < 0) ++report->inward_shells;
  }
}

}  // namespace lte::scene
