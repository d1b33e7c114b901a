#include "datagen/homes/shell.h"

#include <algorithm>

#include "datagen/homes/wall_cells.h"

namespace lte::datagen::homes {
namespace {

struct RoomMaterials {
  int floor, wall, accent, ceiling;
  Side accent_side;
};

RoomMaterials choose_materials(Kit* kit, RoomType type) {
  RoomMaterials m{};
  const bool wet = type == RoomType::Bathroom || type == RoomType::Kitchen;
  m.floor = wet && (type == RoomType::Bathroom || kit->chance(0.6f)) ? kit->palette->floor_tiles()
                                                                     : kit->palette->floor_wood();
  m.wall = type == RoomType::Bathroom && kit->chance(0.75f) ? kit->palette->wall_tiles()
                                                            : kit->palette->wall_paint();
  m.accent = !wet && kit->chance(0.3f) ? kit->palette->wall_paint() : m.wall;
  m.accent_side = kSides[kit->count(0, 3)];
  m.ceiling = kit->palette->ceiling();
  return m;
}

/// A point of a wall: `along` it, at height y.
Vec3 wall_point(Side side, float face, float along, float y) {
  return along_z(side) ? Vec3{face, y, along} : Vec3{along, y, face};
}

void add_quad(Piece* piece, int material, const std::array<Vec3, 4>& corners,
              const std::array<Vec2, 4>& uvs) {
  Mesh quad;
  quad.positions.assign(corners.begin(), corners.end());
  quad.uvs[0].assign(uvs.begin(), uvs.end());
  quad.triangles = {{0, 1, 2}, {0, 2, 3}};
  piece->add(quad, material, {}, false);
}

/// Adds a wall as seen from inside.
void add_wall(Piece* piece, const FloorPlan& plan, int room, Side side, int material) {
  const Rect& r = plan.rooms[static_cast<size_t>(room)].inner;
  const float face = plan.face(room, side);
  const bool flip =
      side == Side::PosX || side == Side::NegZ;  // seen from inside, `along` runs left
  const std::array<float, 2> along{along_z(side) ? r.z0 : r.x0, along_z(side) ? r.z1 : r.x1};
  for (const auto& [a0, a1, y0, y1] :
       wall_cells(plan.openings_of(room), side, along, {0, plan.height})) {
    std::array<Vec3, 4> p{wall_point(side, face, a0, y0), wall_point(side, face, a0, y1),
                          wall_point(side, face, a1, y1), wall_point(side, face, a1, y0)};
    std::array<Vec2, 4> uv{Vec2{a0, -y0}, {a0, -y1}, {a1, -y1}, {a1, -y0}};
    if (!flip) std::swap(p[1], p[3]), std::swap(uv[1], uv[3]);
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    const Vec3 inward =
        wall_point(side, side == Side::NegX || side == Side::NegZ ? 1.0f : -1.0f, 0, 0);
    if (dot(normal, inward) < 0) std::swap(p[1], p[3]), std::swap(uv[1], uv[3]);
    add_quad(piece, material, p, uv);
  }
}

/// Adds skirting along the walls from door to door. The inside is on the left of the way.
void add_skirting(Piece* piece, Kit* kit, const FloorPlan& plan, int room, float height) {
  const Rect& r = plan.rooms[static_cast<size_t>(room)].inner;
  const float w = r.width(), d = r.depth(), total = 2 * (w + d);
  const auto at = [&](float s) -> Vec2 {
    s = s >= total ? s - total : s;
    if (s < w) return {r.x0 + s, r.z1};
    if (s < w + d) return {r.x1, r.z1 - (s - w)};
    if (s < 2 * w + d) return {r.x1 - (s - w - d), r.z0};
    return {r.x0, r.z0 + (s - 2 * w - d)};
  };
  constexpr float kFrame = 0.07f;  // door frames stand in between
  std::vector<std::pair<float, float>> gaps;
  for (const Opening& o : plan.openings_of(room)) {
    if (o.bottom > 0.02f) continue;
    const float from = o.from - kFrame, to = o.to + kFrame;
    switch (o.side) {
      case Side::PosZ:
        gaps.push_back({from - r.x0, to - r.x0});
        break;
      case Side::PosX:
        gaps.push_back({w + r.z1 - to, w + r.z1 - from});
        break;
      case Side::NegZ:
        gaps.push_back({w + d + r.x1 - to, w + d + r.x1 - from});
        break;
      case Side::NegX:
        gaps.push_back({2 * w + d + from - r.z0, 2 * w + d + to - r.z0});
        break;
    }
  }
  std::sort(gaps.begin(), gaps.end());
  const float h = height, t = 0.014f;
  const std::vector<Vec2> profile{{0, 0},        {t, 0}, {t, h - 0.02f}, {0.6f * t, h - 0.008f},
                                  {0.4f * t, h}, {0, h}};
  const float corners[] = {w, w + d, 2 * w + d, total};
  for (size_t i = 0; i < gaps.size(); ++i) {
    const float start = gaps[i].second,
                end = i + 1 < gaps.size() ? gaps[i + 1].first : gaps[0].first + total;
    if (end - start < 0.02f) continue;
    std::vector<Vec2> path{at(start)};
    for (const float lap : {0.0f, total})
      for (const float c : corners)
        if (c + lap > start + 1e-3f && c + lap < end - 1e-3f)
          path.push_back(at(c + lap >= total ? c + lap - total : c + lap));
    path.push_back(at(end));
    piece->add(sweep(path, profile, false), kit->palette->trim(), {}, false);
  }
}

}  // namespace

void build_shell(Stage* stage, Kit* kit) {
  const FloorPlan& plan = stage->plan().floor;
  const float skirting = kit->draw(0.06f, 0.12f);
  for (int room = 0; room < static_cast<int>(plan.rooms.size()); ++room) {
    const PlanRoom& r = plan.rooms[static_cast<size_t>(room)];
    const RoomMaterials m = choose_materials(kit, r.type);
    Piece shell;
    shell.name = std::string("shell ") + room_name(r.type);
    const float h = plan.height;
    const std::array<Vec2, 4> uv{Vec2{r.inner.x0, r.inner.z0},
                                 {r.inner.x0, r.inner.z1},
                                 {r.inner.x1, r.inner.z1},
                                 {r.inner.x1, r.inner.z0}};
    add_quad(&shell, m.floor,
             {Vec3{r.inner.x0, 0, r.inner.z0},
              {r.inner.x0, 0, r.inner.z1},
              {r.inner.x1, 0, r.inner.z1},
              {r.inner.x1, 0, r.inner.z0}},
             uv);
    add_quad(&shell, m.ceiling,
             {Vec3{r.inner.x0, h, r.inner.z0},
              {r.inner.x1, h, r.inner.z0},
              {r.inner.x1, h, r.inner.z1},
              {r.inner.x0, h, r.inner.z1}},
             {uv[0], uv[3], uv[2], uv[1]});
    for (const Side side : kSides)
      add_wall(&shell, plan, room, side, side == m.accent_side ? m.accent : m.wall);
    if (m.wall != kit->palette->wall_tiles()) add_skirting(&shell, kit, plan, room, skirting);
    stage->build(std::move(shell));
  }
}

}  // namespace lte::datagen::homes
