#include "lte/pathtrace/placement/turntable.h"

#include <cmath>

#include "lte/base/check.h"
#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::pathtrace {
namespace {

Turn choose_turn(const Bvh& bvh, const Vec3& origin) {
  if (bvh.bounds().empty()) return Turn::Around;
  if (is_enclosed(bvh, origin)) return Turn::LookRound;
  return open_side_view(bvh, survey(bvh), 1) ? Turn::Swing : Turn::Around;
}

/// What the camera turns about.
Vec3 pivot_of(const Bvh& bvh, const scene::Camera& camera, Turn turn) {
  if (turn == Turn::LookRound || bvh.bounds().empty()) return camera.origin;
  const Vec3 view = normalize(camera.target - camera.origin);
  const float along = dot(bvh.bounds().center() - camera.origin, view);
  return along > 0 ? camera.origin + view * along : bvh.bounds().center();
}

/// `v` turned about +Y, counter-clockwise from above.
Vec3 turned(const Vec3& v, double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

}  // namespace

Turntable turntable(const Bvh& bvh, const scene::Camera& first, int count) {
  LTE_CHECK(count >= 1, "a turntable has 1 camera or more, got ", count);
  Turntable out;
  out.turn = choose_turn(bvh, first.origin);
  const Vec3 pivot = pivot_of(bvh, first, out.turn);
  out.cameras.assign(static_cast<size_t>(count), first);
  for (int i = 1; i < count; ++i) {
    const double phase = 2 * M_PI * i / count;
    const double angle =
        out.turn == Turn::Swing ? kSwingDegrees * M_PI / 180 * std::sin(phase) : phase;
    scene::Camera& camera = out.cameras[static_cast<size_t>(i)];
    camera.origin = pivot + turned(first.origin - pivot, angle);
    camera.target = pivot + turned(first.target - pivot, angle);
    camera.up = turned(first.up, angle);
  }
  return out;
}

}  // namespace lte::pathtrace
