#include "lte/scene/cleanup/duplicates.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>

#include "lte/scene/cleanup/apply.h"

namespace lte::scene {
namespace {

template <typename T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A hash of everything that must be equal in duplicates.
size_t hash_of(const Mesh& mesh) {
  const std::hash<std::string_view> hash;
  size_t out = hash(bytes_of(mesh.triangles)) + 31 * mesh.positions.size() +
               1009 * static_cast<size_t>(mesh.material);
  for (const auto& uvs : mesh.uvs) out = out * 1000003 + hash(bytes_of(uvs));
  return out * 1000003 + hash(bytes_of(mesh.colors));
}

bool same_but_position(const Mesh& a, const Mesh& b) {
  const auto same_uv = [](const std::vector<Vec2>& one, const std::vector<Vec2>& other) {
    return bytes_of(one) == bytes_of(other);
  };
  return a.material == b.material && a.positions.size() == b.positions.size() &&
         a.triangles == b.triangles && a.colors == b.colors &&
         std::equal(a.uvs.begin(), a.uvs.end(), b.uvs.begin(), same_uv);
}

bool same_shape(const Mesh& a, const Mesh& b, double tolerance) {
  Bounds box;
  for (const Vec3& p : a.positions) box.extend(p);
  const double slack = tolerance * length(box.extent());
  const Vec3 offset = b.positions[0] - a.positions[0];
  for (size_t i = 0; i < a.positions.size(); ++i) {
    if (!(length(b.positions[i] - a.positions[i] - offset) <= slack)) return false;
  }
  return true;
}

}  // namespace

std::vector<DuplicateMesh> find_duplicate_meshes(const Scene& scene, double tolerance) {
  std::vector<DuplicateMesh> duplicates(scene.meshes.size());
  std::map<size_t, std::vector<int>> firsts;  // by hash
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.positions.empty()) continue;
    std::vector<int>& candidates = firsts[hash_of(mesh)];
    const auto found = std::find_if(candidates.begin(), candidates.end(), [&](int c) {
      const Mesh& first = scene.meshes[static_cast<size_t>(c)];
      return same_but_position(first, mesh) && same_shape(first, mesh, tolerance);
    });
    if (found == candidates.end()) {
      candidates.push_back(static_cast<int>(m));
    } else {
      duplicates[m] = {*found,
                       mesh.positions[0] - scene.meshes[static_cast<size_t>(*found)].positions[0]};
    }
  }
  return duplicates;
}

int64_t count_duplicate_meshes(const std::vector<DuplicateMesh>& duplicates) {
  return std::count_if(duplicates.begin(), duplicates.end(),
                       [](const DuplicateMesh& duplicate) { return duplicate.mesh != kNone; });
}

void merge_duplicate_meshes(const std::vector<DuplicateMesh>& duplicates, Scene* scene) {
  if (count_duplicate_meshes(duplicates) == 0) return;
  for (Instance& instance : scene->instances) {
    const DuplicateMesh& duplicate = duplicates[static_cast<size_t>(instance.mesh)];
    if (duplicate.mesh == kNone) continue;
    Affine shift;
    for (size_t row = 0; row < 3; ++row) shift.m[row][3] = duplicate.offset[static_cast<int>(row)];
    instance.to_world = instance.to_world * shift;
    instance.mesh = duplicate.mesh;
  }
  drop_unused_meshes(scene);
}

}  // namespace lte::scene
