#include "lte/scene/repeated_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <unordered_map>

#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

constexpr int64_t kHashGrain = 1 << 14;

/// Bits of the corners, the lowest corner first; the winding stays.
using Key = std::array<uint32_t, 9>;

Key key_of(const WorldTriangle& triangle) {
  std::array<std::array<uint32_t, 3>, 3> corners;
  const std::array<Vec3, 3> places{triangle.p0, triangle.p1, triangle.p2};
  for (size_t i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)  // + 0 turns −0 into 0
      corners[i][static_cast<size_t>(axis)] = std::bit_cast<uint32_t>(places[i][axis] + 0.0f);
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  Key key;
  for (size_t i = 0; i < 9; ++i) key[i] = corners[i / 3][i % 3];
  return key;
}

/// Corner by corner, so that the order of corners and of their coordinates counts.
uint64_t hash_of(const Key& key) {
  uint64_t hash = 0;
  for (size_t i = 0; i < 9; i += 3)
    hash =
        mix_bits(hash + (uint64_t{key[i]} << 32 | key[i + 1]) * 0x9e3779b97f4a7c15ULL) ^ key[i + 2];
  return mix_bits(hash);
}

struct KeyHash {
  size_t operator()(const Key& key) const { return hash_of(key); }
};

/// The triangles of all instances, numbered one after another.
class Numbered {
 public:
  explicit Numbered(const Scene& scene) : scene_(scene) {
    size_t total = 0;
    for (const Instance& instance : scene.instances) {
      first_.push_back(total);
      total += mesh_of(instance).triangles.size();
    }
    first_.push_back(total);
  }

  const std::vector<size_t>& first() const { return first_; }
  size_t size() const { return first_.back(); }

  /// Calls `use(number, key)` for those from `begin` to `end` that do not emit, in order.
  template <typename Use>
  void for_each(size_t begin, size_t end, const Use& use) const {
    auto slot = static_cast<size_t>(std::upper_bound(first_.begin(), first_.end(), begin) -
                                    first_.begin() - 1);
    for (size_t at = begin; at < end; ++slot) {
      const size_t last = std::min(end, first_[slot + 1]);
      const Instance& instance = scene_.instances[slot];
      const Mesh& mesh = mesh_of(instance);
      if (!scene_.materials[static_cast<size_t>(mesh.material)].emissive()) {
        for (size_t i = at; i < last; ++i)
          use(i, key_of(world_triangle(mesh, instance.to_world,
                                       static_cast<uint32_t>(i - first_[slot]))));
      }
      at = last;
    }
  }

 private:
  const Mesh& mesh_of(const Instance& instance) const {
    return scene_.meshes[static_cast<size_t>(instance.mesh)];
  }

  const Scene& scene_;
  std::vector<size_t> first_;
};

}  // namespace

RepeatedTriangles::RepeatedTriangles(const Scene& scene) {
  const Numbered triangles(scene);
  const size_t total = triangles.size();
  // 0 for those that emit.
  std::vector<uint32_t> hashes(total);
  parallel_for(static_cast<int64_t>(total), kHashGrain, [&](int64_t begin, int64_t end) {
    triangles.for_each(static_cast<size_t>(begin), static_cast<size_t>(end),
                       [&](size_t number, const Key& key) {
                         hashes[number] = std::max(1u, static_cast<uint32_t>(hash_of(key)));
                       });
  });
  // Few triangles meet another one's hash among so many slots; only these are told apart in full.
  const size_t slots = std::min(std::bit_ceil(8 * total + 1), size_t{1} << 32);
  std::vector<bool> met(slots), shared(slots);
  for (const uint32_t hash : hashes) {
    if (hash == 0) continue;
    const size_t slot = hash & (slots - 1);
    if (met[slot]) shared[slot] = true;
    met[slot] = true;
  }
  std::unordered_map<Key, size_t, KeyHash> seen;
  for (size_t number = 0; number < total; ++number) {
    if (hashes[number] == 0 || !shared[hashes[number] & (slots - 1)]) continue;
    triangles.for_each(number, number + 1, [&](size_t, const Key& key) {
      if (seen.emplace(key, number).second) return;
      if (marks_.empty()) marks_.resize(total);
      marks_[number] = true;
      ++count_;
    });
  }
  first_ = triangles.first();
}

}  // namespace lte::scene
