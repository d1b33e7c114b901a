#include "datagen/homes/sun.h"

#include <array>
#include <vector>

#include "datagen/common/daylight.h"
#include "datagen/homes/wall_cells.h"

namespace lte::datagen::homes {
namespace {

std::vector<Opening> windows_of(const FloorPlan& plan) {
  std::vector<Opening> windows;
  for (const Opening& o : plan.openings)
    if (o.kind == OpeningKind::Window) windows.push_back(o);
  return windows;
}

/// The box that windows and the entrance reach out to.
Bounds hull_of(const FloorPlan& plan) {
  Bounds hull;
  for (const PlanRoom& room : plan.rooms) {
    hull.extend({room.inner.x0 - kRecess, -kRecess, room.inner.z0 - kRecess});
    hull.extend({room.inner.x1 + kRecess, plan.height + kRecess, room.inner.z1 + kRecess});
  }
  return hull;
}

Vec3 outwards(Side side) {
  switch (side) {
    case Side::NegX:
      return {-1, 0, 0};
    case Side::PosX:
      return {1, 0, 0};
    case Side::NegZ:
      return {0, 0, -1};
    default:
      return {0, 0, 1};
  }
}

/// A rectangle of the hull's wall, its front outwards.
Mesh wall_cell(const Bounds& hull, Side side, float from, float to, float low, float high) {
  const Vec3 up{0, high - low, 0};
  switch (side) {
    case Side::NegX:
      return panel({hull.low.x, low, from}, {0, 0, to - from}, up);
    case Side::PosX:
      return panel({hull.high.x, low, to}, {0, 0, from - to}, up);
    case Side::NegZ:
      return panel({to, low, hull.low.z}, {from - to, 0, 0}, up);
    default:
      return panel({from, low, hull.high.z}, {to - from, 0, 0}, up);
  }
}

/// A wall without its windows.
void add_wall(Piece* piece, const Bounds& hull, Side side, const std::vector<Opening>& windows,
              int material) {
  const bool z = along_z(side);
  const std::array<float, 2> along{z ? hull.low.z : hull.low.x, z ? hull.high.z : hull.high.x};
  for (const auto& [a0, a1, y0, y1] : wall_cells(windows, side, along, {hull.low.y, hull.high.y}))
    piece->add(wall_cell(hull, side, a0, a1, y0, y1), material, {}, false);
}

void add_hull(Stage* stage, int material) {
  const FloorPlan& plan = stage->plan().floor;
  const Bounds hull = hull_of(plan);
  const Vec3 size = hull.extent(), x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  Piece piece;
  piece.name = "hull";
  piece.add(panel(hull.low, x, z), material, {}, false);      // x × z = −y
  piece.add(panel(hull.low + y, z, x), material, {}, false);  // z × x = +y
  const std::vector<Opening> windows = windows_of(plan);
  for (const Side side : kSides) add_wall(&piece, hull, side, windows, material);
  stage->build(std::move(piece));
}

}  // namespace

void add_sun_and_sky(Stage* stage, Kit* kit, const Rgb& sky, double picture_share, Rng* rng) {
  add_hull(stage, kit->palette->trim());
  const std::vector<Opening> windows = windows_of(stage->plan().floor);
  const Opening& window = windows.at(rng->below(windows.size()));
  Daylight light = daylight(sky, outwards(window.side), rng);
  add_sun(&light, rng, &stage->scene());
  add_sky(light, picture_share, rng, &stage->scene());
}

}  // namespace lte::datagen::homes
