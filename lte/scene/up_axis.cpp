#include "lte/scene/up_axis.h"

#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::scene {
namespace {

Vec3 turned(const Vec3& v) { return {v.x, v.z, -v.y}; }

}  // namespace

void turn_z_up(Scene* scene) {
  Affine turn;
  turn.m = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
  for (Instance& instance : scene->instances) instance.to_world = turn * instance.to_world;
  for (PunctualLight& light : scene->lights) {
    light.position = turned(light.position);
    light.direction = turned(light.direction);
  }
  for (Camera& camera : scene->cameras) {
    camera.origin = turned(camera.origin);
    camera.target = turned(camera.target);
    camera.up = turned(camera.up);
  }
  if (scene->environment)
    for (Vec3& axis : scene->environment->axes) axis = turned(axis);
}

void set_up_axis(const std::string& axis, const std::string& file, Scene* scene) {
  LTE_CHECK(axis == "y" || axis == "z", "--up ", axis, ": expected y or z");
  if (axis == "y") return;
  const std::string name = lower_case(file);
  LTE_CHECK(!name.ends_with(".gltf") && !name.ends_with(".glb"), file,
            ": --up z: glTF is Y up by its specification");
  turn_z_up(scene);
}

}  // namespace lte::scene
