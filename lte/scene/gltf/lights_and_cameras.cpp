// Cameras and the lights of KHR_lights_punctual, where nodes place them.
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

Camera make_camera(const tinygltf::Camera& camera, const tinygltf::Node& node,
                   const Affine& to_world) {
  Camera out;
  out.name = !camera.name.empty() ? camera.name : node.name;
  out.origin = to_world.point({0, 0, 0});
  out.target = out.origin + normalize(to_world.vector({0, 0, -1}));
  out.up = normalize(to_world.vector({0, 1, 0}));
  out.mirrored = dot(cross(out.target - out.origin, out.up), to_world.vector({1, 0, 0})) < 0;
  out.vfov = static_cast<float>(camera.perspective.yfov * 180.0 / M_PI);
  return out;
}

PunctualLight make_light(const tinygltf::Light& light, const tinygltf::Node& node,
                         const Affine& to_world) {
  PunctualLight out;
  out.name = !light.name.empty() ? light.name : node.name;
  out.kind = light.type == "point"  ? LightKind::Point
             : light.type == "spot" ? LightKind::Spot
                                    : LightKind::Directional;
  out.position = to_world.point({0, 0, 0});
  const Vec3 axis = normalize(to_world.vector({0, 0, -1}));
  out.direction = dot(axis, axis) > 0 ? axis : Vec3{0, 0, -1};
  const auto intensity = static_cast<float>(light.intensity);
  out.intensity = {intensity, intensity, intensity};
  for (size_t c = 0; c < light.color.size(); ++c)
    out.intensity[static_cast<int>(c)] *= static_cast<float>(light.color[c]);
  if (light.range > 0) out.range = static_cast<float>(light.range);
  if (out.kind == LightKind::Spot) {
    out.inner_cone = static_cast<float>(light.spot.innerConeAngle);
    out.outer_cone = static_cast<float>(light.spot.outerConeAngle);
  }
  return out;
}

void add_camera(const Context& context, Camera camera, const std::string& type, Scene* scene) {
  if (type != "perspective") {
    context.ignored.add("orthographic projection", "camera");
  } else if (length(cross(camera.target - camera.origin, camera.up)) < 1e-5f) {
    context.ignored.add("transform without a view direction", "camera");
  } else {
    scene->cameras.push_back(std::move(camera));
  }
}

}  // namespace

void add_lights_and_cameras(const Context& context, const std::vector<Placement>& placements,
                            Scene* scene) {
  for (const Placement& placement : placements) {
    const tinygltf::Node& node = context.model.nodes[static_cast<size_t>(placement.node)];
    ignore_unknown_extensions(node.extensions, "node", &context.ignored);
    if (node.camera >= 0) {
      const tinygltf::Camera& camera = context.model.cameras[static_cast<size_t>(node.camera)];
      add_camera(context, make_camera(camera, node, placement.to_world), camera.type, scene);
    }
    const auto punctual = node.extensions.find("KHR_lights_punctual");
    if (punctual == node.extensions.end() || !punctual->second.Has("light")) continue;
    const auto index = static_cast<size_t>(punctual->second.Get("light").GetNumberAsInt());
    PunctualLight light = make_light(context.model.lights[index], node, placement.to_world);
    LTE_CHECK(is_finite(light.intensity), context.file.name, ": light ", index,
              ": its intensity is not finite");
    light.light_group = static_cast<int>(scene->light_groups.size());
    if (light.name.empty()) light.name = concat("light ", index);
    scene->light_groups.push_back(light.name);
    scene->lights.push_back(std::move(light));
  }
}

}  // namespace lte::scene::gltf
