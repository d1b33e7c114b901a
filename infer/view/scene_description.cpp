#include "infer/view/scene_description.h"

#include <cmath>

namespace lte::infer::view {
namespace {

Vec3 column(const Affine& a, size_t number) {
  return {a.m[0][number], a.m[1][number], a.m[2][number]};
}

float across(const Vec3& v) { return std::hypot(v.x, v.z); }

}  // namespace

Affine placed(const Placement& placement, const Vec3& foot) {
  const float angle = placement.turn * kPi / 180;
  const float cosine = placement.scale * std::cos(angle), sine = placement.scale * std::sin(angle);
  Affine out;
  out.m = {{{cosine, 0, sine, 0}, {0, placement.scale, 0, 0}, {-sine, 0, cosine, 0}}};
  const Vec3 shift = foot + placement.move - out.vector(foot);
  for (int axis = 0; axis < 3; ++axis) out.m[static_cast<size_t>(axis)][3] = shift[axis];
  return out;
}

/// Turning about the vertical keeps how long a column is across, so the longest one tells best.
Placement placement_of(const Affine& loaded, const Affine& now, const Vec3& foot) {
  if (loaded.m == now.m) return {};
  size_t best = 0;
  for (size_t i = 1; i < 3; ++i) {
    if (across(column(loaded, i)) > across(column(loaded, best))) best = i;
  }
  const Vec3 before = column(loaded, best), after = column(now, best);
  Placement out;
  out.scale = across(after) / across(before);
  const float turn = std::atan2(before.z, before.x) - std::atan2(after.z, after.x);
  out.turn = std::remainder(turn * 180 / kPi, 360.0f);
  const Affine turned = placed({{}, out.turn, out.scale}, foot);
  out.move = column(now, 3) - turned.point(column(loaded, 3));
  return out;
}

}  // namespace lte::infer::view
