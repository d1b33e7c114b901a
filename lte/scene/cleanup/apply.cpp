#include "lte/scene/cleanup/apply.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace lte::scene {
namespace {

/// The mesh without the marked triangles.
Mesh without(const Mesh& mesh, const std::vector<bool>& removed) {
  Mesh out = mesh;
  out.triangles.clear();
  for (size_t t = 0; t < removed.size(); ++t) {
    if (!removed[t]) out.triangles.push_back(mesh.triangles[t]);
  }
  return out;
}

void drop_instances(const std::vector<bool>& dropped, Scene* scene) {
  std::vector<Instance> kept;
  for (size_t i = 0; i < dropped.size(); ++i) {
    if (!dropped[i]) kept.push_back(scene->instances[i]);
  }
  scene->instances = std::move(kept);
}

/// Removes light groups that nothing is in, and numbers the others anew.
void drop_empty_groups(Scene* scene) {
  std::vector<bool> used(scene->light_groups.size());
  const auto each = [&](const auto& visit) {
    for (Instance& instance : scene->instances) visit(&instance.light_group);
    for (PunctualLight& light : scene->lights) visit(&light.light_group);
    if (scene->environment) visit(&scene->environment->light_group);
  };
  each([&](const int* group) {
    if (*group != kNone) used[static_cast<size_t>(*group)] = true;
  });
  std::vector<int> number(used.size(), kNone);
  std::vector<std::string> names;
  for (size_t g = 0; g < used.size(); ++g) {
    if (!used[g]) continue;
    number[g] = static_cast<int>(names.size());
    names.push_back(std::move(scene->light_groups[g]));
  }
  scene->light_groups = std::move(names);
  each([&](int* group) {
    if (*group != kNone) *group = number[static_cast<size_t>(*group)];
  });
}

}  // namespace

void snap_vertices(const WorldTopology& topology, Scene* scene) {
  std::vector<bool> done(scene->meshes.size());
  for (size_t i = 0; i < scene->instances.size(); ++i) {
    const auto index = static_cast<size_t>(scene->instances[i].mesh);
    if (done[index]) continue;
    done[index] = true;
    std::vector<Vec3>& positions = scene->meshes[index].positions;
    std::unordered_map<uint32_t, uint32_t> first;  // vertex of a place
    for (uint32_t v = 0; v < positions.size(); ++v) {
      const auto [at, is_new] = first.emplace(topology.place(static_cast<int>(i), v), v);
      if (!is_new) positions[v] = positions[at->second];
    }
  }
}

int64_t remove_triangles(const std::vector<bool>& removed, Scene* scene) {
  // Instances of a mesh that lose the same triangles go on sharing one.
  std::map<std::pair<int, std::vector<bool>>, int> versions;
  std::vector<bool> dropped(scene->instances.size());
  std::vector<Mesh> fresh;
  const auto first_fresh = static_cast<int>(scene->meshes.size());
  int64_t count = 0;
  size_t next = 0;
  for (size_t i = 0; i < scene->instances.size(); ++i) {
    Instance& instance = scene->instances[i];
    const Mesh& mesh = scene->meshes[static_cast<size_t>(instance.mesh)];
    // The marks of this instance's triangles.
    const auto begin = removed.begin() + static_cast<std::ptrdiff_t>(next);
    next += mesh.triangles.size();
    std::vector<bool> pattern(begin, removed.begin() + static_cast<std::ptrdiff_t>(next));
    const auto gone = std::count(pattern.begin(), pattern.end(), true);
    count += gone;
    if (gone == 0) continue;
    dropped[i] = static_cast<size_t>(gone) == pattern.size();
    if (dropped[i]) continue;
    const auto [version, is_new] = versions.try_emplace(
        {instance.mesh, pattern}, first_fresh + static_cast<int>(fresh.size()));
    if (is_new) fresh.push_back(without(mesh, pattern));
    instance.mesh = version->second;
  }
  if (count == 0) return 0;
  for (Mesh& mesh : fresh) scene->meshes.push_back(std::move(mesh));
  drop_instances(dropped, scene);
  drop_unused_meshes(scene);
  drop_empty_groups(scene);
  return count;
}

void drop_unused_meshes(Scene* scene) {
  std::vector<int> number(scene->meshes.size(), kNone);
  for (const Instance& instance : scene->instances) number[static_cast<size_t>(instance.mesh)] = 0;
  std::vector<Mesh> kept;
  for (size_t m = 0; m < number.size(); ++m) {
    if (number[m] == kNone) continue;
    number[m] = static_cast<int>(kept.size());
    kept.push_back(std::move(scene->meshes[m]));
  }
  scene->meshes = std::move(kept);
  for (Instance& instance : scene->instances)
    instance.mesh = number[static_cast<size_t>(instance.mesh)];
}

}  // namespace lte::scene
