// Lamps on walls and in windows.
#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"
#include "datagen/wild/lamp_maker.h"
#include "datagen/wild/shell.h"

namespace lte::datagen::wild {

using homes::translation;

bool LampMaker::stretch(float least, float most, Stretch* out) {
  const size_t e = dice_->rng.below(cell().outline.size());
  const float length = edge_of(cell().outline, e).length;
  float top = INFINITY;
  for (const Vec2& p : cell().top_of(e)) top = std::min(top, p.y - cell().floor);
  const float w = length * dice_->draw(least, most), h = top * dice_->draw(least, most);
  out->edge = e;
  out->u0 = dice_->draw(0, 1) * (length - w);
  out->u1 = out->u0 + w;
  out->low = dice_->draw(0, 1) * (top - h);
  out->high = out->low + h;
  return cell().is_wall(e, out->u0, out->u1, cell().floor + out->low, cell().floor + out->high,
                        0.02f * scale_);
}

/// A picture that shines, on a wall or out in the room.
bool LampMaker::screen() {
  Stretch s;
  if (!stretch(0.15f, 0.8f, &s)) return false;
  const float w = s.u1 - s.u0, h = s.high - s.low,
              z = scale_ * (dice_->chance(0.7f) ? 0.02f : dice_->draw(0.1f, 0.8f));
  const Affine at = edge_frame(cell(), s.edge) * translation({s.u0, s.low, z});
  if (!claim({{0, 0, -0.005f * scale_}, {w, h, 0.005f * scale_}}, at, 0.002f)) return false;
  float mean = 0;
  const bool both = dice_->chance(0.3f);
  const int material =
      builder_->materials->screen(builder_->materials->lamp_color(dice_), both, &mean);
  lamp_.materials.push_back(material);
  lamp_.power += kPi * w * h * mean * (both ? 2.0f : 1.0f);
  builder_->add(homes::panel({}, {w, 0, 0}, {0, h, 0}), material, at, "screen");
  return true;
}

/// A part of a wall, up to nearly all of it.
bool LampMaker::glowing_wall() {
  Stretch s;
  if (!stretch(0.3f, 0.98f, &s)) return false;
  const float w = s.u1 - s.u0, h = s.high - s.low, z = 0.005f * scale_;
  const Affine at = edge_frame(cell(), s.edge) * translation({s.u0, s.low, z});
  const OrientedBox box = homes::oriented_box({{0, 0, 0}, {w, h, z}}, at);
  if (!builder_->is_free(cell_, box, 0)) return false;
  builder_->taken[static_cast<size_t>(cell_)].push_back(box);
  shine(sheet_of({}, {w, 0, 0}, {0, h, 0}), at, 1);
  return true;
}

/// A strip on a ledge under the ceiling, behind a lip: it shines at the ceiling alone.
bool LampMaker::cove() {
  Stretch s;
  if (!stretch(0.5f, 0.95f, &s)) return false;
  float top = INFINITY;
  for (const Vec2& p : cell().top_of(s.edge)) top = std::min(top, p.y - cell().floor);
  const float y = top - scale_ * dice_->draw(0.12f, 0.45f), w = s.u1 - s.u0,
              d = scale_ * dice_->draw(0.08f, 0.25f), t = 0.015f * scale_,
              lip = scale_ * dice_->draw(0.03f, 0.1f), z = 0.003f * scale_;
  if (y < 0.3f * top ||
      !cell().is_wall(s.edge, s.u0, s.u1, cell().floor + y, cell().floor + top, 0.01f * scale_))
    return false;
  const Affine at = edge_frame(cell(), s.edge) * translation({s.u0, y, z});
  if (!claim({{0, 0, 0}, {w, lip, d}}, at, 0.001f)) return false;
  body(block({0, 0, 0}, {w, t, d - t}), at);
  body(block({0, 0, d - t}, {w, lip, d}), at);
  const float strip = (d - t) * dice_->draw(0.15f, 0.6f), from = 0.3f * (d - t - strip);
  shine(sheet_of({0.02f * w, 1.02f * t, from + strip}, {0.96f * w, 0, 0}, {0, 0, -strip}), at, 1);
  return true;
}

/// A panel between a wall and a board that stands before it, on either of the two.
bool LampMaker::behind_board() {
  Stretch s;
  if (!stretch(0.15f, 0.6f, &s)) return false;
  const float w = s.u1 - s.u0, h = s.high - s.low, gap = scale_ * dice_->log_draw(0.05f, 0.5f),
              t = scale_ * dice_->log_draw(0.004f, 0.05f), z = 0.005f * scale_;
  const Affine at = edge_frame(cell(), s.edge) * translation({s.u0, s.low, z});
  if (!claim({{0, 0, 0}, {w, h, gap + t}}, at, 0.001f)) return false;
  body(block({0, 0, gap}, {w, h, gap + t}), at);
  const float share = dice_->draw(0.3f, 0.95f), x = 0.5f * w * (1 - share),
              y = 0.5f * h * (1 - share);
  if (dice_->chance(0.5f)) {
    shine(sheet_of({x, y, 0}, {share * w, 0, 0}, {0, share * h, 0}), at, 1);
  } else {
    shine(
        sheet_of({w - x, y, gap - 0.1f * std::min(gap, t)}, {-share * w, 0, 0}, {0, share * h, 0}),
        at, 1);
  }
  return true;
}

/// A window whose pane shines inwards.
bool LampMaker::pane() {
  Cell& room = builder_->plan->cells[static_cast<size_t>(cell_)];
  for (size_t e = 0; e < room.holes.size(); ++e) {
    for (Hole& hole : room.holes[e]) {
      if (hole.other >= 0 || hole.kind == OpeningKind::Missing || hole.closed) continue;
      hole.closed = true;
      shine(pane_mesh(edge_of(room.outline, e), hole), {}, 1);
      return true;
    }
  }
  return false;
}

}  // namespace lte::datagen::wild
