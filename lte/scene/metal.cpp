#include "lte/scene/metal.h"

#include <algorithm>
#include <cmath>

#include "lte/base/text.h"
#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"

namespace lte::scene {

bool is_default_metal(const Material& material) {
  return material.metallic == 1 && material.roughness == 1 &&
         material.metallic_roughness_texture.texture == kNone;
}

MetalShare metal_share(const Scene& scene) {
  double total = 0, metal = 0, by_default = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const Material& material = scene.materials[static_cast<size_t>(mesh.material)];
    const bool textured = material.metallic_roughness_texture.texture != kNone;
    double area_sum = 0, metal_sum = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto triangle = static_cast<uint32_t>(t);
      const double a = area(world_triangle(mesh, instance.to_world, triangle));
      area_sum += a;
      if (material.metallic == 0) continue;
      const Gloss gloss = textured ? evaluate_gloss(scene, static_cast<int>(i), triangle, 1.0f / 3,
                                                    1.0f / 3, static_cast<float>(std::sqrt(a)))
                                   : Gloss{material.metallic, material.roughness};
      metal_sum += a * double{gloss.metallic};
    }
    total += area_sum;
    metal += metal_sum;
    if (is_default_metal(material)) by_default += metal_sum;
  }
  if (!(total > 0)) return {};
  return {metal / total, by_default / total};
}

bool all_metal(const Scene& scene) {
  return std::all_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& each) {
    const int mesh = scene.meshes[static_cast<size_t>(each.mesh)].material;
    const Material& material = scene.materials[static_cast<size_t>(mesh)];
    return material.metallic >= 1 && material.metallic_roughness_texture.texture == kNone;
  });
}

std::string metal_text(const MetalShare& share, const std::string& of) {
  if (!(share.metal > 0)) return "";
  const char* reason =
      share.by_default > 0.5 * share.metal
          ? " (metallic 1 and roughness 1, as glTF has it where a file says nothing)"
          : "";
  return formatted("%.3g %% of the %s is metal%s", 100 * share.metal, of.c_str(), reason);
}

}  // namespace lte::scene
