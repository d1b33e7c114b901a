// Lamps under ceilings and in free space.
#include <algorithm>
#include <cmath>

#include "datagen/homes/furniture/furniture.h"
#include "datagen/wild/lamp_maker.h"
#include "lte/scene/luminaire_power.h"

namespace lte::datagen::wild {
namespace {

using homes::rotation;
using homes::scaling;

/// A cone or drum without ends, a single sheet.
Mesh frustum(float low_radius, float top_radius, float height, int turn) {
  Mesh mesh;
  for (int i = 0; i <= turn; ++i) {
    const float a = 2 * kPi * static_cast<float>(i % turn) / static_cast<float>(turn);
    const Vec3 out{std::cos(a), 0, std::sin(a)};
    const float u = static_cast<float>(i) / static_cast<float>(turn);
    mesh.positions.push_back(out * low_radius);
    mesh.positions.push_back(out * top_radius + Vec3{0, height, 0});
    mesh.uvs[0].push_back({u, 1});
    mesh.uvs[0].push_back({u, 0});
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(2 * turn); i += 2) {
    mesh.triangles.push_back({i, i + 1, i + 2});
    mesh.triangles.push_back({i + 2, i + 1, i + 3});
  }
  return mesh;
}

Bounds ball_bounds(const Vec3& centre, float r) {
  return {centre - Vec3{r, r, r}, centre + Vec3{r, r, r}};
}

}  // namespace

float area_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += 0.5 * length(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                              mesh.positions[t[2]] - mesh.positions[t[0]]));
  return static_cast<float>(sum);
}

bool LampMaker::point(float margin, Vec2* p) {
  Bounds bounds;
  for (const Vec2& corner : cell().outline) bounds.extend(in_space(corner, 0));
  for (int tries = 0; tries < 12; ++tries) {
    *p = {dice_->draw(bounds.low.x, bounds.high.x), dice_->draw(bounds.low.z, bounds.high.z)};
    if (inside(cell().outline, *p, margin)) return true;
  }
  return false;
}

float LampMaker::angle() {
  const Vec2 along = edge_of(cell().outline, 0).along;
  return dice_->chance(0.7f) ? std::atan2(-along.y, along.x) : dice_->draw(0, 2 * kPi);
}

bool LampMaker::claim(const Bounds& bounds, const Affine& at, float margin) {
  const OrientedBox box = homes::oriented_box(bounds, at);
  if (!builder_->fits(cell_, box, margin) || !builder_->is_free(cell_, box, 0.005f * scale_))
    return false;
  builder_->taken[static_cast<size_t>(cell_)].push_back(box);
  return true;
}

void LampMaker::shine(Mesh&& mesh, const Affine& at, int faces) {
  const int material =
      builder_->materials->emitter("lamp", builder_->materials->lamp_color(dice_), faces == 2);
  lamp_.materials.push_back(material);
  lamp_.power += kPi * area_of(mesh) * static_cast<float>(faces);
  builder_->add(std::move(mesh), material, at, "lamp");
}

/// A thin housing on a flat ceiling, whose bottom shines.
bool LampMaker::flush_panel() {
  if (cell().ceiling.kind != CeilingKind::Flat) return hanging_panel(false);
  const float a = scale_ * dice_->log_draw(0.05f, 1.8f), b = a * dice_->log_draw(0.08f, 1),
              t = scale_ * dice_->log_draw(0.003f, 0.06f);
  Vec2 p;
  if (!point(0.5f * b + 0.02f * scale_, &p)) return false;
  const float top = cell().ceiling.eaves;
  const Affine at = standing(p, top - t, angle());
  const Vec3 low{-a / 2, 0, -b / 2}, x{a, 0, 0}, y{0, t * 0.999f, 0}, z{0, 0, b};
  // Under the ceiling, which fits() wants some room to.
  const OrientedBox box = homes::oriented_box({low - Vec3{0, 0.02f * scale_, 0}, low + x + z}, at);
  if (!builder_->fits(cell_, box, 0.01f * scale_ + 0.0f * t) ||
      !builder_->is_free(cell_, box, 0.02f))
    return false;
  builder_->taken[static_cast<size_t>(cell_)].push_back(box);
  Mesh sides;
  for (const Mesh& face : {sheet_of(low, z, y), sheet_of(low + x + z, -z, y),
                           sheet_of(low + x, -x, y), sheet_of(low + z, x, y)})
    homes::append(&sides, face, {});
  body(std::move(sides), at);
  shine(sheet_of(low, x, z), at, 1);
  return true;
}

/// A level sheet at some distance below the ceiling; a third of them are strips.
bool LampMaker::hanging_panel(bool two_sided) {
  const bool strip = dice_->chance(0.33f);
  const float a = scale_ * dice_->log_draw(strip ? 0.4f : 0.1f, 1.8f),
              b = strip ? scale_ * dice_->draw(0.02f, 0.12f) : a * dice_->draw(0.3f, 1);
  Vec2 p;
  if (!point(0.5f * b, &p)) return false;
  const float turn = angle(), drop = scale_ * dice_->log_draw(0.02f, 0.9f);
  const Vec3 low{-a / 2, 0, -b / 2}, x{a, 0, 0}, z{0, 0, b};
  float top = INFINITY;
  for (const Vec2& corner :
       outline_of(homes::oriented_box({low, low + x + z}, standing(p, 0, turn))))
    top = std::min(top, cell().height_at(corner));
  const Affine at = standing(p, top - drop, turn);
  if (!claim({low, low + x + z}, at, 0.01f * scale_)) return false;
  shine(sheet_of(low, x, z), at, two_sided ? 2 : 1);
  if (!two_sided && dice_->chance(0.5f))
    body(sheet_of(low + Vec3{0, 0.004f * scale_, 0} + z, x, -z), at);
  return true;
}

/// A sheet on edge in the room.
bool LampMaker::upright_sheet() {
  const float a = scale_ * dice_->log_draw(0.15f, 1.6f), h = a * dice_->draw(0.3f, 1.5f);
  Vec2 p;
  if (h > 0.8f * height() || !point(0.1f * scale_, &p)) return false;
  const float y = cell().floor + dice_->draw(0.02f, 1) * (height() - h) * 0.95f;
  const Affine at = standing(p, y, angle());
  const Vec3 low{-a / 2, 0, 0};
  if (!claim({low - Vec3{0, 0, 0.005f}, {a / 2, h, 0.005f}}, at, 0.01f * scale_)) return false;
  shine(sheet_of(low, {a, 0, 0}, {0, h, 0}), at, 2);
  return true;
}

/// A ball that hangs, floats or lies; some are in a cup.
bool LampMaker::globe() {
  const float r = scale_ * dice_->log_draw(0.02f, 0.4f);
  Vec2 p;
  if (2.2f * r > height() || !point(1.5f * r, &p)) return false;
  const float room = 0.95f * (height() - 2 * r), share = dice_->draw(0, 1);
  const float y = cell().floor + r + 0.001f + room * (dice_->chance(0.2f) ? 0.0f : share);
  const Affine at = standing(p, y, 0);
  const bool cup = dice_->chance(0.2f);
  if (!claim(ball_bounds({}, cup ? 1.45f * r : r), at, 0.002f)) return false;
  shine(ball({}, r, 4 * dice_->count(2, 5)), at, 1);
  if (!cup) return true;
  const float wide = 1.3f * r, t = 0.05f * r, deep = r * dice_->draw(0.6f, 1.4f);
  Mesh shell = homes::lathe({{wide - t, -deep}, {wide, -deep}, {wide, r}, {wide - t, r}}, 16, true);
  body(std::move(shell), at * rotation(0, dice_->chance(0.8f) ? 0 : 90));
  return true;
}

bool LampMaker::tube() {
  const float r = scale_ * dice_->log_draw(0.006f, 0.06f),
              l = scale_ * dice_->log_draw(0.25f, 2.2f);
  const bool upright = dice_->chance(0.35f);
  Vec2 p;
  if (!point(2 * r, &p) || (upright && l > 0.9f * height())) return false;
  const float size = upright ? l : 2 * r;
  const float y = cell().floor + 0.002f +
                  (0.98f * height() - size) * (upright ? dice_->draw(0, 1) : dice_->draw(0.3f, 1));
  const Vec3 half{upright ? r : l / 2, size / 2, r};
  const Affine at = standing(p, y + size / 2, angle());
  if (!claim({-half, half}, at, 0.004f)) return false;
  shine(homes::lathe({{0, -l / 2}, {r, -l / 2}, {r, l / 2}, {0, l / 2}}, 8),
        upright ? at : at * rotation(2, 90), 1);
  return true;
}

/// A cone or drum without ends: it glows on both sides, or hides a bulb.
bool LampMaker::open_shade() {
  const float r0 = scale_ * dice_->log_draw(0.06f, 0.4f), r1 = r0 * dice_->draw(0.3f, 1),
              h = r0 * dice_->draw(0.5f, 2.5f);
  Vec2 p;
  if (1.2f * h > height() || !point(1.1f * r0, &p)) return false;
  const float y = cell().floor + dice_->draw(0.1f, 0.95f) * (height() - h);
  const Affine at = standing(p, y, 0);
  if (!claim({{-r0, 0, -r0}, {r0, h, r0}}, at, 0.004f)) return false;
  Mesh shade = frustum(r0, r1, h, 4 * dice_->count(3, 6));
  if (dice_->chance(0.3f)) {  // opening upwards
    for (Vec3& q : shade.positions) q.y = h - q.y;
    for (auto& t : shade.triangles) std::swap(t[1], t[2]);
  }
  if (dice_->chance(0.5f)) {
    shine(std::move(shade), at, 2);
  } else {
    body(std::move(shade), at);
    shine(ball({0, 0.5f * h, 0}, 0.35f * r1, 8), at, 1);
  }
  return true;
}

/// A floor lamp, a table lamp on the floor or a pendant of datagen/homes.
bool LampMaker::kit_lamp() {
  const float size = scale_ * dice_->draw(0.7f, 1.3f);
  Vec2 p;
  if (!point(0.25f * scale_, &p)) return false;
  const int kind = dice_->count(0, 2);
  homes::Piece piece;
  if (kind == 2) {
    const float top = (cell().height_at(p) - cell().floor) / size;
    piece = homes::make_pendant(kit_, top, top * dice_->draw(0.5f, 0.8f));
  } else {
    piece = kind == 0 ? homes::make_floor_lamp(kit_) : homes::make_table_lamp(kit_);
  }
  Bounds bounds = piece.bounds();
  bounds = {bounds.low * size, bounds.high * size};
  const Affine at = standing(p, cell().floor, angle());
  Bounds checked = bounds;
  if (kind == 2) checked.high.y -= 0.05f * scale_;
  checked.low.y += 1e-3f;
  if (!claim(checked, at, 0.004f)) return false;
  for (const auto& [material, mesh] : piece.meshes) {
    scene::Material& emitter = builder_->scene->materials[static_cast<size_t>(material)];
    if (!emitter.emissive()) continue;
    emitter.emission = emitter.emission / luminance(emitter.emission);
    lamp_.materials.push_back(material);
    lamp_.power += kPi * area_of(mesh) * size * size;
  }
  builder_->add(std::move(piece), at * scaling({size, size, size}));
  return lamp_.power > 0;
}

bool LampMaker::punctual(bool spot) {
  Vec2 p;
  if (!point(0.05f * scale_, &p)) return false;
  scene::PunctualLight light;
  light.name = spot ? "spot" : "point";
  light.kind = spot ? scene::LightKind::Spot : scene::LightKind::Point;
  const float room = cell().height_at(p) - cell().floor;
  light.position = in_space(
      p, cell().floor + room * (spot ? dice_->draw(0.6f, 0.98f) : dice_->draw(0.05f, 0.97f)));
  if (!claim(ball_bounds({}, 0.01f * scale_), standing(p, light.position.y, 0), 0)) return false;
  if (spot) {
    const float tilt = dice_->draw(0, 1.2f), turn = dice_->draw(0, 2 * kPi);
    light.direction = normalize(
        Vec3{std::sin(tilt) * std::cos(turn), -std::cos(tilt), std::sin(tilt) * std::sin(turn)});
    light.outer_cone = dice_->log_draw(0.2f, 1.3f);
    light.inner_cone = light.outer_cone * dice_->draw(0, 0.9f);
  }
  light.intensity = builder_->materials->lamp_color(dice_);
  light.light_group = builder_->group;
  lamp_.power += luminance(scene::punctual_power(light));
  lamp_.lights.push_back(builder_->scene->lights.size());
  builder_->scene->lights.push_back(light);
  return true;
}

bool LampMaker::place(LampKind kind, int index) {
  cell_ = index;
  lamp_ = {};
  lamp_.kind = kind;
  const bool placed = [&] {
    switch (kind) {
      case LampKind::FlushPanel:
        return flush_panel();
      case LampKind::HangingPanel:
        return hanging_panel(false);
      case LampKind::TwoSidedSheet:
        return dice_->chance(0.65f) ? hanging_panel(true) : upright_sheet();
      case LampKind::Globe:
        return globe();
      case LampKind::Tube:
        return tube();
      case LampKind::OpenShade:
        return open_shade();
      case LampKind::Kit:
        return kit_lamp();
      case LampKind::Spot:
      case LampKind::Point:
        return punctual(kind == LampKind::Spot);
      case LampKind::Screen:
        return screen();
      case LampKind::GlowingWall:
        return glowing_wall();
      case LampKind::Cove:
        return cove();
      case LampKind::BehindBoard:
        return behind_board();
      case LampKind::Pane:
        return pane();
      case LampKind::Shell:
        return false;
    }
    return false;
  }();
  if (placed) builder_->lamps.push_back(lamp_);
  return placed;
}

}  // namespace lte::datagen::wild
