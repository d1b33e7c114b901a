#include "lte/scene/light_gains.h"

#include <cmath>
#include <map>
#include <utility>

#include "lte/base/check.h"

namespace lte::scene {
namespace {

class Dimmer {
 public:
  Dimmer(const Scene& scene, std::span<const float> gains, std::vector<int>* tree_of_mesh)
      : scene_(scene), gains_(gains), tree_of_mesh_(*tree_of_mesh), out_(scene) {
    tree_of_mesh_.clear();
    for (size_t i = 0; i < scene.meshes.size(); ++i) tree_of_mesh_.push_back(static_cast<int>(i));
  }

  Scene run() {
    for (Instance& instance : out_.instances) {
      if (instance.light_group == kNone || gain(instance.light_group) == 1) continue;
      instance.mesh = dimmed_mesh(instance.mesh, instance.light_group);
      if (gain(instance.light_group) == 0) instance.light_group = kNone;
    }
    for (PunctualLight& light : out_.lights)
      if (light.light_group != kNone) scale(light.light_group, &light.intensity);
    std::erase_if(out_.lights, [this](const PunctualLight& light) {
      return light.light_group != kNone && gain(light.light_group) == 0;
    });
    if (out_.environment && out_.environment->light_group != kNone) {
      scale(out_.environment->light_group, &out_.environment->radiance);
      if (gain(out_.environment->light_group) == 0) out_.environment.reset();
    }
    return std::move(out_);
  }

 private:
  float gain(int group) const { return gains_[static_cast<size_t>(group)]; }

  void scale(int group, Rgb* light) const {
    *light *= gain(group);
    LTE_CHECK(is_finite(*light), "light \"", scene_.light_groups[static_cast<size_t>(group)],
              "\": gain ", gain(group), " makes its light infinite");
  }

  int dimmed_mesh(int mesh, int group) {
    const auto [at, is_new] = mesh_of_.try_emplace({mesh, gain(group)}, size_of(out_.meshes));
    if (is_new) {
      Mesh copy = scene_.meshes[static_cast<size_t>(mesh)];
      copy.material = dimmed_material(copy.material, group);
      out_.meshes.push_back(std::move(copy));
      tree_of_mesh_.push_back(mesh);
    }
    return at->second;
  }

  int dimmed_material(int material, int group) {
    const auto [at, is_new] =
        material_of_.try_emplace({material, gain(group)}, size_of(out_.materials));
    if (is_new) {
      Material copy = scene_.materials[static_cast<size_t>(material)];
      scale(group, &copy.emission);
      if (gain(group) == 0) copy.emission_texture = {};
      out_.materials.push_back(std::move(copy));
    }
    return at->second;
  }

  template <typename T>
  static int size_of(const std::vector<T>& entries) {
    return static_cast<int>(entries.size());
  }

  const Scene& scene_;
  std::span<const float> gains_;
  std::vector<int>& tree_of_mesh_;
  Scene out_;
  std::map<std::pair<int, float>, int> mesh_of_, material_of_;
};

}  // namespace

Scene with_gains(const Scene& scene, std::span<const float> gains, std::vector<int>* tree_of_mesh) {
  LTE_CHECK(gains.size() == scene.light_groups.size(), "gains: expected ",
            scene.light_groups.size(), ", one a light, got ", gains.size());
  for (size_t i = 0; i < gains.size(); ++i)
    LTE_CHECK(gains[i] >= 0 && std::isfinite(gains[i]), "light \"", scene.light_groups[i],
              "\": gain: expected 0 or more, got ", gains[i]);
  return Dimmer(scene, gains, tree_of_mesh).run();
}

}  // namespace lte::scene
