#include "lte/bake/texel_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::bake {
namespace {

constexpr int64_t kGrain = 2048;
/// In edges of a texel: the eight around it, if the grid is turned too.
constexpr float kReach = 1.5f;
/// How far a neighbour may lie off the plane, in edges, and how far its normal may turn (cosine).
constexpr float kOffPlane = 0.35f, kTurn = 0.9f;
/// Height above the surface, in edges, at which neighbours see one another.
constexpr float kSight = 0.1f;

using Cell = std::array<int32_t, 3>;

/// Places by cubic cells, sorted by the hash of their cell.
struct CellTable {
  explicit CellTable(const GraphPlaces& places) {
    std::vector<float> edges(places.edge.begin(), places.edge.end());
    std::nth_element(edges.begin(), edges.begin() + static_cast<int64_t>(edges.size() / 2),
                     edges.end());
    size = std::max(1e-6f, 1.5f * kReach * edges[edges.size() / 2]);
    const size_t count = places.position.size();
    int bits = 1;
    while ((size_t{1} << bits) < 2 * count) ++bits;
    shift = 64 - bits;
    begin.assign((size_t{1} << bits) + 1, 0);
    std::vector<uint32_t> slot(count);
    for (size_t i = 0; i < count; ++i) {
      slot[i] = slot_of(cell_of(places.position[i]));
      ++begin[slot[i] + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    member.resize(count);
    std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
    for (size_t i = 0; i < count; ++i) member[next[slot[i]]++] = static_cast<uint32_t>(i);
  }
  Cell cell_of(const Vec3& p) const {
    return {static_cast<int32_t>(std::floor(p.x / size)),
            static_cast<int32_t>(std::floor(p.y / size)),
            static_cast<int32_t>(std::floor(p.z / size))};
  }
  uint32_t slot_of(const Cell& c) const {
    const uint64_t a = (uint64_t{static_cast<uint32_t>(c[0])} << 32) | static_cast<uint32_t>(c[1]);
    return static_cast<uint32_t>(hash_combine(a, static_cast<uint32_t>(c[2])) >> shift);
  }

  float size = 1;
  int shift = 0;
  std::vector<uint32_t> begin, member;
};

struct Finder {
  const pathtrace::Bvh& bvh;
  const GraphPlaces& places;
  const CellTable table;

  bool sees(size_t i, size_t j) const {
    const auto lifted = [&](size_t k) {
      return pathtrace::offset_origin(
          places.position[k] + places.normal[k] * (kSight * places.edge[k]), places.normal[k]);
    };
    const Vec3 from = lifted(i);
    pathtrace::Ray ray{from, lifted(j) - from};
    ray.t_max = 1;
    return !bvh.occluded(ray);
  }

  bool near(size_t i, size_t j) const {
    const Vec3 way = places.position[j] - places.position[i];
    const float edge = std::min(places.edge[i], places.edge[j]);
    return dot(way, way) <= kReach * kReach * edge * edge &&
           dot(places.normal[i], places.normal[j]) >= kTurn &&
           std::abs(dot(way, places.normal[i])) <= kOffPlane * edge &&
           std::abs(dot(way, places.normal[j])) <= kOffPlane * edge;
  }

  /// Those with a larger number: the others have it in their own list.
  void find(size_t i, std::vector<uint32_t>* out) const {
    if (places.skipped[i] != 0) return;
    const float reach = kReach * places.edge[i];
    const Cell low = table.cell_of(places.position[i] - Vec3{reach, reach, reach});
    const Cell high = table.cell_of(places.position[i] + Vec3{reach, reach, reach});
    Cell c;
    for (c[0] = low[0]; c[0] <= high[0]; ++c[0]) {
      for (c[1] = low[1]; c[1] <= high[1]; ++c[1]) {
        for (c[2] = low[2]; c[2] <= high[2]; ++c[2]) {
          const uint32_t slot = table.slot_of(c);
          for (uint32_t k = table.begin[slot]; k < table.begin[slot + 1]; ++k) {
            const uint32_t j = table.member[k];
            if (j <= i || places.skipped[j] != 0 || table.cell_of(places.position[j]) != c)
              continue;
            if (near(i, j) && sees(i, j)) out->push_back(j);
          }
        }
      }
    }
  }
};

}  // namespace

TexelGraph::TexelGraph(const pathtrace::Bvh& bvh, const GraphPlaces& places) {
  const size_t count = places.position.size();
  first_.assign(count + 1, 0);
  if (count == 0) return;
  const Finder finder{bvh, places, CellTable(places)};
  std::vector<std::vector<uint32_t>> blocks((count + kGrain - 1) / kGrain);
  std::vector<uint32_t> larger(count);
  parallel_for(static_cast<int64_t>(count), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      std::vector<uint32_t>& found = blocks[static_cast<size_t>(i / kGrain)];
      const size_t before = found.size();
      finder.find(static_cast<size_t>(i), &found);
      larger[static_cast<size_t>(i)] = static_cast<uint32_t>(found.size() - before);
    }
  });
  const auto for_pairs = [&](const auto& use) {
    for (size_t i = 0, at = 0; i < count; ++i) {
      if (i % kGrain == 0) at = 0;
      for (uint32_t k = 0; k < larger[i]; ++k) use(i, blocks[i / kGrain][at++]);
    }
  };
  for_pairs([&](size_t i, uint32_t j) {
    ++first_[i + 1];
    ++first_[j + 1];
  });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  other_.resize(first_.back());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for_pairs([&](size_t i, uint32_t j) {
    other_[next[i]++] = j;
    other_[next[j]++] = static_cast<uint32_t>(i);
  });
}

template <typename Value>
std::vector<Value> TexelGraph::spread(std::vector<Value> values, int times) const {
  std::vector<Value> out(times > 0 ? values.size() : 0);
  for (int k = 0; k < times; ++k) {
    parallel_for(static_cast<int64_t>(size()), kGrain, [&](int64_t begin, int64_t end) {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
        Value sum = values[i];
        for (uint32_t e = first_[i]; e < first_[i + 1]; ++e) sum += values[other_[e]];
        out[i] = sum / static_cast<float>(first_[i + 1] - first_[i] + 1);
      }
    });
    std::swap(values, out);
  }
  return values;
}

template std::vector<float> TexelGraph::spread(std::vector<float>, int) const;
template std::vector<Rgb> TexelGraph::spread(std::vector<Rgb>, int) const;

}  // namespace lte::bake
