#include <cmath>
#include <optional>

#include "bench/pareto/pareto.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/scene/load_camera.h"

namespace lte::bench {
namespace {

constexpr float kTurn = 8 * kPi / 180;

/// Turns a camera in its place: its origin stays in free space.
scene::Camera turned(const scene::Camera& camera, float angle) {
  const Vec3 axis = normalize(camera.up), view = camera.target - camera.origin;
  const float c = std::cos(angle), s = std::sin(angle);
  scene::Camera out = camera;
  out.target =
      camera.origin + view * c + cross(axis, view) * s + axis * (dot(axis, view) * (1 - c));
  return out;
}

}  // namespace

std::vector<scene::Camera> pareto_views(const pathtrace::Bvh& bvh, const std::string& word,
                                        int count, float aspect) {
  std::optional<scene::CameraChoice> choice;
  if (!word.empty()) {
    choice = scene::find_cameras(bvh.scene(), word);
  } else if (!bvh.scene().cameras.empty()) {
    choice = scene::CameraChoice{{bvh.scene().cameras.front()}, false};
  }
  std::vector<scene::Camera> views =
      choice ? choice->cameras
             : std::vector{pathtrace::auto_camera(bvh, scene::auto_camera_seed(word), aspect)};
  const auto wanted = static_cast<size_t>(count);
  if (views.size() > wanted) views.resize(wanted);
  const scene::Camera first = views.front();
  for (int k = 1; views.size() < wanted; ++k) {
    const auto steps = static_cast<float>((k + 1) / 2);
    views.push_back(turned(first, k % 2 == 1 ? steps * kTurn : -steps * kTurn));
  }
  return views;
}

}  // namespace lte::bench
