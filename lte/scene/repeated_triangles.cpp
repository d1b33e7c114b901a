#include "lte/scene/repeated_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <functional>
#include <string_view>
#include <unordered_map>

#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

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

struct KeyHash {
  size_t operator()(const Key& key) const {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(key.data()), sizeof(Key)});
  }
};

template <typename Use>
void for_each_triangle(const Scene& scene, const Use& use) {
  size_t index = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const bool emits = scene.materials[static_cast<size_t>(mesh.material)].emissive();
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t, ++index)
      if (!emits) use(index, key_of(world_triangle(mesh, instance.to_world, t)));
  }
}

}  // namespace

RepeatedTriangles::RepeatedTriangles(const Scene& scene) {
  size_t total = 0;
  for (const Instance& instance : scene.instances) {
    first_.push_back(total);
    total += scene.meshes[static_cast<size_t>(instance.mesh)].triangles.size();
  }
  // Few triangles meet another one's hash among so many slots; only these are told apart in full.
  const size_t slots = std::bit_ceil(8 * total + 1);
  std::vector<bool> met(slots), shared(slots);
  const KeyHash hash;
  for_each_triangle(scene, [&](size_t, const Key& key) {
    const size_t slot = hash(key) & (slots - 1);
    if (met[slot]) shared[slot] = true;
    met[slot] = true;
  });
  std::unordered_map<Key, size_t, KeyHash> seen;
  for_each_triangle(scene, [&](size_t index, const Key& key) {
    if (!shared[hash(key) & (slots - 1)] || seen.emplace(key, index).second) return;
    if (marks_.empty()) marks_.resize(total);
    marks_[index] = true;
    ++count_;
  });
}

}  // namespace lte::scene
