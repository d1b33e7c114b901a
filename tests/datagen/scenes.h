// Scenes with closed-form irradiance, and small data-set settings that bake in milliseconds.
#pragma once

#include <cmath>

#include "datagen/common/parts.h"
#include "datagen/dataset/config.h"
#include "lte/scene/scene.h"

namespace lte::datagen::test {

/// A closed unit cube seen from inside, all of whose faces emit `radiance` and reflect `albedo`.
/// Everywhere on it, light of depth k + 1 gives irradiance π·radiance·albedo^k.
inline scene::Scene furnace(float radiance, float albedo) {
  scene::Scene scene;
  scene.name = "furnace";
  scene::Material material;
  material.name = "wall";
  material.base_color = Rgb{1, 1, 1} * albedo;
  material.emission = Rgb{1, 1, 1} * radiance;
  scene.materials = {material};
  const int mesh = add_meshes(&scene, "cube", {{{0, 0, 0}, {1, 1, 1}, 0, kAllFaces, 0, true}})[0];
  scene.instances.push_back({mesh, {}, 0});
  scene.light_groups = {"cube"};
  return scene;
}

/// π·radiance·(albedo^first + ... + albedo^(last)), the irradiance of depths first + 1 to last + 1.
inline float furnace_irradiance(float radiance, float albedo, int first, int last) {
  float sum = 0;
  for (int k = first; k <= last; ++k) sum += std::pow(albedo, static_cast<float>(k));
  return kPi * radiance * sum;
}

inline BakeOptions tiny_bake() {
  BakeOptions options;
  options.scene_points = 64;
  options.query_points = 48;
  options.rays = 8;
  options.views = {1, 8, 6, 8};
  return options;
}

inline DatagenConfig tiny_config() {
  DatagenConfig config;
  config.scenes = 5;
  config.val_share = config.test_share = 0.2;
  config.bake = tiny_bake();
  config.bake.prune = false;  // costs more than the rest of so small a scene
  config.boxes.texture_sizes = {8};
  return config;
}

}  // namespace lte::datagen::test
