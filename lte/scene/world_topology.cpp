#include "lte/scene/world_topology.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
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
#include "lte/scene/disjoint_sets.h"

namespace lte::scene {
namespace {

using Index = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;
using Pair = std::pair<uint32_t, uint32_t>;

/// Of one point; what is denser still is joined through its nearest neighbours.
constexpr int kMaxNeighbours = 16;
constexpr int64_t kGrain = 4096;

auto key(const Vec3& p) { return std::tie(p.x, p.y, p.z); }

std::vector<Vec3> world_vertices(const Scene& scene, std::vector<size_t>* first) {
  std::vector<Vec3> out;
  for (const Instance& instance : scene.instances) {
    first->push_back(out.size());
    for (const Vec3& p : scene.meshes[static_cast<size_t>(instance.mesh)].positions)
      out.push_back(instance.to_world.point(p) + Vec3{0, 0, 0});  // -0 becomes 0
  }
  LTE_CHECK(out.size() < UINT32_MAX, scene.name, ": ", out.size(),
            " instanced vertices are too many to compare");
  return out;
}

/// Numbers different positions in the order of their coordinates.
std::vector<uint32_t> number_positions(const std::vector<Vec3>& vertices,
                                       std::vector<Vec3>* positions) {
  std::vector<uint32_t> order(vertices.size()), number(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return key(vertices[a]) < key(vertices[b]); });
  for (const uint32_t i : order) {
    if (positions->empty() || !(positions->back() == vertices[i]))
      positions->push_back(vertices[i]);
    number[i] = static_cast<uint32_t>(positions->size() - 1);
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
    for (const auto& [a, b] : near_pairs(&points, tolerance)) sets.join(a, b);
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

}  // namespace

WorldTopology build_topology(const Scene& scene, double tolerance) {
  WorldTopology out;
  std::vector<Vec3> positions;
  {
    const std::vector<Vec3> vertices = world_vertices(scene, &out.first_vertex);
    out.place_of_vertex = number_positions(vertices, &positions);
  }
  const std::vector<uint32_t> place = join_near(positions, tolerance, &out.places);
  for (uint32_t& number : out.place_of_vertex) number = place[number];
  out.near_duplicates = static_cast<int64_t>(positions.size() - out.places.size());
  out.triangles.reserve(static_cast<size_t>(scene.triangle_count()));
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const bool mirrored = scene.instances[i].to_world.determinant() < 0;
    const auto instance = static_cast<int>(i);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      PlacedTriangle placed{
          {out.place(instance, a), out.place(instance, b), out.place(instance, c)}, instance, t};
      if (mirrored) std::swap(placed.place[1], placed.place[2]);
      out.triangles.push_back(placed);
    }
  }
  return out;
}

}  // namespace lte::scene
