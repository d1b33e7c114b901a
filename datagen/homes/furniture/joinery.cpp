// Doorways and windows: reveals, frames, leaves, panes and sills.
#include <algorithm>

#include "datagen/common/parts.h"
#include "datagen/homes/shell.h"

namespace lte::datagen::homes {
namespace {

/// Local frame of an opening seen from its room: x along the wall from its middle, y up from the
/// floor, +z into the room, z = 0 on the wall's face.
Affine opening_frame(const FloorPlan& plan, const Opening& o) {
  static constexpr double kTurn[] = {90, 270, 0, 180};  // +z turns towards +x
  const float face = plan.face(o.room, o.side), middle = (o.from + o.to) / 2;
  const Vec3 at = along_z(o.side) ? Vec3{face, 0, middle} : Vec3{middle, 0, face};
  return placement(kTurn[static_cast<size_t>(o.side)], at);
}

/// The inside of the hole, from the face to `depth` behind it, without front and back.
void add_reveal(Piece* piece, const Opening& o, float depth, int material, int threshold,
                const Affine& at) {
  const float w = (o.to - o.from) / 2, h = o.top - o.bottom;
  const Vec3 in{0, 0, depth}, up{0, h, 0}, across{2 * w, 0, 0};
  piece->add(panel({-w, o.bottom, 0}, -in, up), material, at, false);
  piece->add(panel({w, o.bottom, -depth}, in, up), material, at, false);
  piece->add(panel({-w, o.top, -depth}, across, in), material, at, false);
  Mesh floor = panel({-w, o.bottom, 0}, across, -in);
  fit_uvs(&floor, {0, 0}, {2 * w, depth});
  piece->add(floor, threshold, at, false);
}

/// A flat frame around the hole on one side of the wall.
void add_architrave(Piece* piece, Kit* kit, const Opening& o, const Affine& at) {
  const float w = (o.to - o.from) / 2, bar = 0.065f, t = 0.016f;
  // A path in the xz plane around three sides, stood upright; the profile grows outwards.
  const std::vector<Vec2> path{{w, 0}, {w, -o.top}, {-w, -o.top}, {-w, 0}};
  const std::vector<Vec2> profile{
      {0, 0}, {0, t}, {-0.7f * bar, 0.8f * t}, {-bar, 0.4f * t}, {-bar, 0}};
  piece->add(sweep(path, profile, false), kit->palette->trim(), at * rotation(0, 90), false);
}

void add_entrance(Piece* piece, Kit* kit, const Opening& o, const Affine& at) {
  const float w = (o.to - o.from) / 2, depth = o.depth;
  const int leaf = kit->palette->front(), metal = kit->palette->metal();
  kit->block(piece, {-w, 0, -depth - 0.02f}, {w, o.top, -depth + 0.02f}, leaf, 0.002f, at);
  for (const auto& [y0, y1] : {std::pair{0.15f, 0.85f}, std::pair{1.05f, 1.9f}})
    for (const auto& [x0, x1] : {std::pair{-w + 0.12f, -0.05f}, std::pair{0.05f, w - 0.12f}})
      kit->block(piece, {x0, y0, -depth + 0.012f}, {x1, y1, -depth + 0.03f}, leaf, 0.008f, at);
  Mesh knob = lathe(
      smooth(
          std::vector<Vec2>{
              {0, 0}, {0.012f, 0}, {0.01f, 0.03f}, {0.028f, 0.045f}, {0.02f, 0.065f}, {0, 0.068f}},
          3),
      kit->detail.turn(0.028f));
  piece->add(knob, metal, at * translation({w - 0.07f, 0.98f, -depth + 0.02f}) * rotation(0, 90));
}

void add_pane(Piece* piece, Kit* kit, const Opening& o, const Rgb& daylight, const Affine& at) {
  const float w = (o.to - o.from) / 2;
  // What meets a pane from within leaves the home.
  const int material = max_component(daylight) > 0
                           ? kit->palette->emitter("pane", daylight * kit->draw(0.7f, 1), 0)
                           : kit->palette->screen();
  piece->add(panel({-w, o.bottom, -o.depth}, {2 * w, 0, 0}, {0, o.top - o.bottom, 0}), material, at,
             false);
}

/// Casements: an outer frame, bars between the panes, and a sill that stands out.
void add_casements(Piece* piece, Kit* kit, const Opening& o, const Affine& at) {
  const float w = (o.to - o.from) / 2, b = o.bottom, t = o.top, z = -o.depth;
  const int trim = kit->palette->trim();
  const std::vector<Vec2> path{{-w, -b}, {w, -b}, {w, -t}, {-w, -t}};
  const std::vector<Vec2> profile{
      {0, 0}, {0.055f, 0}, {0.055f, 0.03f}, {0.045f, 0.045f}, {0, 0.045f}};
  piece->add(sweep(path, profile, true), trim,
             at * translation({0, 0, z + 0.002f}) * rotation(0, 90), false);
  const int casements = w > 0.42f ? (w > 0.85f ? 3 : 2) : 1;
  for (int i = 1; i < casements; ++i) {
    const float x = -w + 2 * w * static_cast<float>(i) / static_cast<float>(casements);
    kit->block(piece, {x - 0.035f, b + 0.04f, z + 0.004f}, {x + 0.035f, t - 0.04f, z + 0.042f},
               trim, 0.006f, at);
  }
  if (t - b > 1 && kit->chance(0.6f)) {
    const float y = t - kit->draw(0.3f, 0.45f);
    kit->block(piece, {-w + 0.04f, y - 0.025f, z + 0.006f}, {w - 0.04f, y + 0.025f, z + 0.038f},
               trim, 0.006f, at);
  }
  kit->block(piece, {-w - 0.05f, b - 0.03f, -0.002f}, {w + 0.05f, b, 0.045f}, trim, 0.008f, at);
}

}  // namespace

void build_openings(Stage* stage, Kit* kit, Windows windows, const Rgb& daylight) {
  const FloorPlan& plan = stage->plan().floor;
  const int threshold = kit->palette->floor_wood(), trim = kit->palette->trim();
  for (const Opening& o : plan.openings) {
    const Affine at = opening_frame(plan, o);
    Piece piece;
    piece.name = o.kind == OpeningKind::Window ? "window" : "door";
    if (o.kind == OpeningKind::Window) {
      add_reveal(&piece, o, o.depth, trim, trim, at);
      if (windows == Windows::Panes) add_pane(&piece, kit, o, daylight, at);
      add_casements(&piece, kit, o, at);
    } else {
      add_reveal(&piece, o, o.depth, trim, threshold, at);
      add_architrave(&piece, kit, o, at);
      if (o.kind == OpeningKind::Entrance) {
        add_entrance(&piece, kit, o, at);
      } else {
        Opening back = o;
        std::swap(back.room, back.other);
        back.side = opposite(o.side);
        add_architrave(&piece, kit, back, opening_frame(plan, back));
      }
    }
    stage->build(std::move(piece));
  }
}

}  // namespace lte::datagen::homes
