#include "lte/bake/light_group.h"

#include <map>

#include "lte/base/check.h"

namespace lte::bake {

scene::Scene with_light_of(const scene::Scene& scene, int group, std::vector<int>* tree_of_mesh) {
  LTE_CHECK(group >= 0 && group < static_cast<int>(scene.light_groups.size()),
            "there is no light group ", group);
  scene::Scene out = scene;
  tree_of_mesh->clear();
  for (size_t i = 0; i < scene.meshes.size(); ++i) tree_of_mesh->push_back(static_cast<int>(i));
  std::map<int, int> unlit_mesh, unlit_material;
  for (scene::Instance& instance : out.instances) {
    if (instance.light_group == group || instance.light_group == scene::kNone) continue;
    const int mesh = instance.mesh;
    const auto [at, is_new] = unlit_mesh.try_emplace(mesh, static_cast<int>(out.meshes.size()));
    if (is_new) {
      scene::Mesh copy = scene.meshes[static_cast<size_t>(mesh)];
      const auto [made, first] =
          unlit_material.try_emplace(copy.material, static_cast<int>(out.materials.size()));
      if (first) {
        scene::Material dark = scene.materials[static_cast<size_t>(copy.material)];
        dark.emission = {};
        dark.emission_texture = {};
        out.materials.push_back(std::move(dark));
      }
      copy.material = made->second;
      out.meshes.push_back(std::move(copy));
      tree_of_mesh->push_back(mesh);
    }
    instance.mesh = at->second;
    instance.light_group = scene::kNone;
  }
  std::erase_if(out.lights,
                [&](const scene::PunctualLight& light) { return light.light_group != group; });
  if (out.environment && out.environment->light_group != group) out.environment.reset();
  return out;
}

}  // namespace lte::bake
