#include "lte/scene/inspect/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Woverloaded-virtual"
#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/serialization.h>
#pragma GCC diagnostic pop

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/parallel_sort.h"
#include "lte/scene/inspect/disjoint_sets.h"

namespace lte::scene {
namespace {

using Index = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;
using Pair = std::pair<uint32_t, uint32_t>;

/// Neighbours asked for at each point. What is denser still is joined through the nearest ones.
constexpr int kMaxNeighbours = 16;
constexpr int64_t kGrain = 4096;

struct Vertex {
  Vec3 position;
  uint32_t number;
};

std::vector<Vertex> world_vertices(const Scene& scene, std::vector<size_t>* first) {
  size_t count = 0;
  for (const Instance& instance : scene.instances) {
    first->push_back(count);
    count += scene.meshes[static_cast<size_t>(instance.mesh)].positions.size();
  }
  LTE_CHECK(count < UINT32_MAX, scene.name, ": ", count,
            " instanced vertices are too many to compare");
  std::vector<Vertex> out;
  out.reserve(count);
  for (const Instance& instance : scene.instances) {
    for (const Vec3& p : scene.meshes[static_cast<size_t>(instance.mesh)].positions)
      out.push_back({instance.to_world.point(p) + Vec3{0, 0, 0},  // -0 becomes 0
                     static_cast<uint32_t>(out.size())});
  }
  return out;
}

/// Numbers different positions in the order of their coordinates.
std::vector<uint32_t> number_positions(std::vector<Vertex> vertices, std::vector<Vec3>* positions) {
  parallel_sort(&vertices, [](const Vertex& a, const Vertex& b) {
    return std::tie(a.position.x, a.position.y, a.position.z, a.number) <
           std::tie(b.position.x, b.position.y, b.position.z, b.number);
  });
  std::vector<uint32_t> number(vertices.size());
  positions->reserve(vertices.size());
  for (const Vertex& v : vertices) {
    if (positions->empty() || !(positions->back() == v.position)) positions->push_back(v.position);
    number[v.number] = static_cast<uint32_t>(positions->size() - 1);
  }
  return number;
}

/// Positions in a cube of edge 1, so that squares neither overflow nor vanish.
std::vector<float> scaled(const std::vector<Vec3>& positions, const Bounds& box, double edge) {
  std::vector<float> out;
  out.reserve(positions.size() * 3);
  for (const Vec3& p : positions) {
    for (int c = 0; c < 3; ++c)
      out.push_back(static_cast<float>((double{p[c]} - box.low[c]) / edge));
  }
  return out;
}

/// How often a cell of a grid is met by the boxes of `tolerance` around points, in hashed counters:
/// never too low, seldom too high.
class CellCounts {
 public:
  CellCounts(const std::vector<float>& points, double tolerance)
      : edge_(std::max(kEdge * tolerance, 1e-12)),
        reach_(1.001 * tolerance),
        bits_(std::bit_width(kCounters * points.size() / 3)),
        counts_(size_t{1} << bits_) {
    for (size_t i = 0; i < points.size(); i += 3) {
      std::array<int64_t, 3> low, high;
      for (size_t c = 0; c < 3; ++c) {
        low[c] = cell(points[i + c] - reach_);
        high[c] = cell(points[i + c] + reach_);
      }
      for (int64_t x = low[0]; x <= high[0]; ++x)
        for (int64_t y = low[1]; y <= high[1]; ++y)
          for (int64_t z = low[2]; z <= high[2]; ++z) {
            uint8_t& count = counts_[slot(x, y, z)];
            if (count < 2) ++count;
          }
    }
  }

  /// False only if no other point is within the tolerance.
  bool maybe_near(const float* p) const {
    return counts_[slot(cell(p[0]), cell(p[1]), cell(p[2]))] > 1;
  }

 private:
  static constexpr double kEdge = 32;     // so that few boxes meet more than one cell
  static constexpr size_t kCounters = 8;  // a point

  int64_t cell(double x) const { return static_cast<int64_t>(std::floor(x / edge_)); }
  size_t slot(int64_t x, int64_t y, int64_t z) const {
    const uint64_t hash = static_cast<uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                          static_cast<uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL ^
                          static_cast<uint64_t>(z) * 0x165667b19e3779f9ULL;
    return static_cast<size_t>((hash ^ hash >> 29) * 0xbf58476d1ce4e5b9ULL >> (64 - bits_));
  }

  double edge_, reach_;
  int bits_;
  std::vector<uint8_t> counts_;
};

/// The points that may have a near one: a tree of them alone gives the same neighbours as one of
/// all.
std::vector<uint32_t> candidates(const std::vector<float>& points, double tolerance) {
  const CellCounts counts(points, tolerance);
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < points.size() / 3; ++i)
    if (counts.maybe_near(&points[size_t{3} * i])) out.push_back(i);
  return out;
}

std::vector<Pair> near_pairs(std::vector<float>* points, double tolerance) {
  const size_t count = points->size() / 3;
  Index index(flann::Matrix<float>(points->data(), count, 3),
              flann::KDTreeSingleIndexParams(/*leaf_max_size=*/16, /*reorder=*/true));
  index.buildIndex();
  flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, 0, /*sorted=*/false);
  params.max_neighbors = kMaxNeighbours;
  std::vector<Pair> out;
  std::mutex mutex;
  parallel_for(static_cast<int64_t>(count), kGrain, [&](int64_t begin, int64_t end) {
    std::vector<std::vector<size_t>> found;
    std::vector<std::vector<float>> distances;
    const flann::Matrix<float> queries(points->data() + 3 * begin, static_cast<size_t>(end - begin),
                                       3);
    index.radiusSearch(queries, found, distances, static_cast<float>(tolerance * tolerance),
                       params);
    std::vector<Pair> pairs;
    for (size_t i = 0; i < found.size(); ++i) {
      const auto own = static_cast<uint32_t>(static_cast<size_t>(begin) + i);
      for (const size_t other : found[i]) {
        if (other != own) pairs.emplace_back(own, static_cast<uint32_t>(other));
      }
    }
    const std::lock_guard lock(mutex);
    out.insert(out.end(), pairs.begin(), pairs.end());
  });
  return out;
}

/// Joins positions within the tolerance: the place of each, and one position a place.
std::vector<uint32_t> join_near(const std::vector<Vec3>& positions, double tolerance,
                                std::vector<Vec3>* places) {
  Bounds box;
  for (const Vec3& p : positions) box.extend(p);
  const double edge = std::hypot(double{box.high.x} - box.low.x, double{box.high.y} - box.low.y,
                                 double{box.high.z} - box.low.z);
  DisjointSets sets(positions.size());
  if (tolerance > 0 && edge > 0 && positions.size() > 1) {
    std::vector<float> points = scaled(positions, box, edge);
    const std::vector<uint32_t> chosen = candidates(points, tolerance);
    for (size_t i = 0; i < chosen.size(); ++i)
      std::copy_n(&points[size_t{3} * chosen[i]], 3, &points[3 * i]);
    points.resize(3 * chosen.size());
    if (chosen.size() > 1)
      for (const auto& [a, b] : near_pairs(&points, tolerance)) sets.join(chosen[a], chosen[b]);
  }
  std::vector<uint32_t> place(positions.size());
  for (uint32_t i = 0; i < positions.size(); ++i) {
    const uint32_t root = sets.root(i);  // never above i
    if (root == i) {
      place[i] = static_cast<uint32_t>(places->size());
      places->push_back(positions[i]);
    } else {
      place[i] = place[root];
    }
  }
  return place;
}

/// Numbers places anew in the order in which vertices meet them: what is near on a surface is then
/// near in memory, and the passes over triangles that follow are several times faster.
void number_by_vertices(WorldTopology* topology) {
  std::vector<uint32_t> number(topology->places.size(), UINT32_MAX);
  std::vector<Vec3> places;
  places.reserve(number.size());
  for (uint32_t& place : topology->place_of_vertex) {
    uint32_t& own = number[place];
    if (own == UINT32_MAX) {
      own = static_cast<uint32_t>(places.size());
      places.push_back(topology->places[place]);
    }
    place = own;
  }
  topology->places = std::move(places);
}

}  // namespace

WorldTopology build_topology(const Scene& scene, double tolerance) {
  WorldTopology out;
  std::vector<Vec3> positions;
  out.place_of_vertex = number_positions(world_vertices(scene, &out.first_vertex), &positions);
  const std::vector<uint32_t> place = join_near(positions, tolerance, &out.places);
  for (uint32_t& number : out.place_of_vertex) number = place[number];
  out.near_duplicates = static_cast<int64_t>(positions.size() - out.places.size());
  number_by_vertices(&out);
  out.triangles.resize(static_cast<size_t>(scene.triangle_count()));
  size_t first = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const bool mirrored = scene.instances[i].to_world.determinant() < 0;
    const auto instance = static_cast<int>(i);
    const auto fill = [&](int64_t begin, int64_t end) {
      for (auto t = static_cast<size_t>(begin); t < static_cast<size_t>(end); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        PlacedTriangle placed{
            {out.place(instance, a), out.place(instance, b), out.place(instance, c)},
            instance,
            static_cast<uint32_t>(t)};
        if (mirrored) std::swap(placed.place[1], placed.place[2]);
        out.triangles[first + t] = placed;
      }
    };
    parallel_for(static_cast<int64_t>(mesh.triangles.size()), 16 * kGrain, fill);
    first += mesh.triangles.size();
  }
  return out;
}

}  // namespace lte::scene
