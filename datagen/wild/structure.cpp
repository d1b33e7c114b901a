#include "datagen/wild/structure.h"

#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::wild {
namespace {

using homes::rotation;
using homes::translation;

class Structure {
 public:
  Structure(Builder* builder, Dice* dice)
      : builder_(builder), dice_(dice), scale_(builder->plan->unit / 4) {}

  void build(int index) {
    index_ = index;
    for (size_t e = 0; e < cell().outline.size(); ++e) {
      for (const Hole& hole : cell().holes[e]) {
        if (hole.kind == OpeningKind::Ajar && (hole.reveal || hole.depth == 0)) leaf(e, hole);
        if (hole.kind == OpeningKind::Window && dice_->chance(0.4f)) bars(e, hole);
        keep_free(e, hole);
      }
    }
    if (cell().rectangular() && height() > 0.65f * builder_->plan->unit &&
        dice_->chance(kShares.mezzanine))
      mezzanine();
    if (dice_->chance(kShares.columns))
      for (int i = dice_->count(1, 6); i > 0; --i) column();
    if (dice_->chance(kShares.boards))
      for (int i = dice_->count(1, 3); i > 0; --i) board();
  }

 private:
  const Cell& cell() const { return builder_->plan->cells[static_cast<size_t>(index_)]; }
  float height() const { return cell().ceiling.eaves - cell().floor; }
  int material() { return builder_->materials->thing(); }

  void leaf(size_t edge, const Hole& hole);
  void bars(size_t edge, const Hole& hole);
  void keep_free(size_t edge, const Hole& hole);
  void mezzanine();
  void column();
  void board();
  /// Adds a box where nothing is, and remembers it.
  bool put(const Vec3& low, const Vec3& high, const Affine& at, const char* name);

  Builder* builder_;
  Dice* dice_;
  float scale_;
  int index_ = 0;
};

bool Structure::put(const Vec3& low, const Vec3& high, const Affine& at, const char* name) {
  const OrientedBox box = homes::oriented_box({low, high}, at);
  if (!builder_->fits(index_, box, 0.002f) || !builder_->is_free(index_, box, 0.005f)) return false;
  builder_->add(block(low, high), material(), at, name);
  builder_->taken[static_cast<size_t>(index_)].push_back(box);
  return true;
}

/// A door leaf that stands open by 2 to 100 degrees, into the room.
void Structure::leaf(size_t edge, const Hole& hole) {
  const float width = hole.u1 - hole.u0 - 0.01f * scale_, high = hole.top.front().y - hole.low,
              thick = 0.035f * scale_, angle = dice_->log_draw(2, 100);
  const bool left = dice_->chance(0.5f);
  const Affine at =
      edge_frame(cell(), edge) *
      translation({left ? hole.u0 : hole.u1, hole.low - cell().floor, 0.004f * scale_}) *
      rotation(1, left ? -angle : angle);
  const Vec3 low{left ? 0 : -width, 0.005f * scale_, 0}, top{left ? width : 0, high * 0.99f, thick};
  builder_->add(block(low, top), material(), at, "door");
  builder_->taken[static_cast<size_t>(index_)].push_back(homes::oriented_box({low, top}, at));
}

void Structure::bars(size_t edge, const Hole& hole) {
  const float w = hole.u1 - hole.u0, h = hole.top.front().y - hole.low,
              thick = scale_ * dice_->draw(0.015f, 0.05f), z = -0.5f * hole.depth - thick;
  const int across = dice_->count(0, 5), up = dice_->count(across == 0 ? 1 : 0, 5);
  const Affine at = edge_frame(cell(), edge) * translation({hole.u0, hole.low - cell().floor, 0});
  const int wood = material();
  for (int i = 1; i <= across; ++i) {
    const float x = w * static_cast<float>(i) / static_cast<float>(across + 1);
    builder_->add(block({x - thick / 2, 0, z}, {x + thick / 2, h, z + thick}), wood, at, "bar");
  }
  for (int i = 1; i <= up; ++i) {
    const float y = h * static_cast<float>(i) / static_cast<float>(up + 1);
    builder_->add(block({0, y - thick / 2, z}, {w, y + thick / 2, z + thick}), wood, at, "bar");
  }
}

/// Nothing stands right before most passages.
void Structure::keep_free(size_t edge, const Hole& hole) {
  if (hole.other < 0 || hole.kind == OpeningKind::Slit || dice_->chance(0.2f)) return;
  const float deep = 0.5f * scale_, up = hole.low - cell().floor;
  builder_->taken[static_cast<size_t>(index_)].push_back(homes::oriented_box(
      {{hole.u0, up, 0}, {hole.u1, up + 1.8f * scale_, deep}}, edge_frame(cell(), edge)));
}

/// A slab across one end, with thin posts along its free side.
void Structure::mezzanine() {
  const size_t edge = dice_->rng.below(4);
  const Edge wall = edge_of(cell().outline, edge);
  const float depth = edge_of(cell().outline, (edge + 1) % 4).length * dice_->draw(0.25f, 0.55f),
              y = height() * dice_->draw(0.4f, 0.6f), thick = scale_ * dice_->draw(0.05f, 0.25f),
              gap = 0.004f * scale_;
  const Affine at = edge_frame(cell(), edge);
  if (!put({gap, y, gap}, {wall.length - gap, y + thick, depth}, at, "mezzanine")) return;
  if (!dice_->chance(0.6f)) return;
  const float high = std::min(0.9f * scale_, 0.8f * (height() - y - thick)),
              post = scale_ * dice_->draw(0.01f, 0.03f);
  const int posts = dice_->count(3, 14);
  const int metal = material();
  for (int i = 0; i < posts; ++i) {
    const float x = wall.length * (static_cast<float>(i) + 0.5f) / static_cast<float>(posts);
    builder_->add(
        block({x, y + thick, depth - 2 * post}, {x + post, y + thick + high, depth - post}), metal,
        at, "post");
  }
  builder_->add(block({gap, y + thick + high, depth - 3 * post},
                      {wall.length - gap, y + thick + high + post, depth}),
                metal, at, "rail");
}

void Structure::column() {
  const float r = scale_ * dice_->log_draw(0.04f, 0.3f);
  const Bounds bounds = [&] {
    Bounds b;
    for (const Vec2& p : cell().outline) b.extend(in_space(p, 0));
    return b;
  }();
  const Vec2 p{dice_->draw(bounds.low.x, bounds.high.x), dice_->draw(bounds.low.z, bounds.high.z)};
  if (!inside(cell().outline, p, 1.6f * r)) return;
  float top = cell().height_at(p);
  for (const Vec2& d : {Vec2{r, r}, {-r, r}, {r, -r}, {-r, -r}})
    top = std::min(top, cell().height_at(p + d * 1.42f));
  const float high =
      (top - cell().floor) * (dice_->chance(0.8f) ? 0.998f : dice_->draw(0.2f, 0.9f));
  const Affine at = standing(p, cell().floor, dice_->draw(0, kPi));
  if (dice_->chance(0.4f)) {
    put({-r, 0, -r}, {r, high, r}, at, "column");
    return;
  }
  const OrientedBox box = homes::oriented_box({{-r, 0, -r}, {r, high, r}}, at);
  if (!builder_->is_free(index_, box, 0.005f)) return;
  builder_->add(homes::lathe({{0, 0}, {r, 0}, {r, high}, {0, high}}, 4 * dice_->count(2, 6)),
                material(), at, "column");
  builder_->taken[static_cast<size_t>(index_)].push_back(box);
}

/// A wall that stands free, from a millimetre to a hand thick.
void Structure::board() {
  const Polygon& outline = cell().outline;
  const Vec2 centre = centre_of(outline);
  const float width = std::sqrt(area_of(outline)) * dice_->draw(0.2f, 0.6f),
              thick = scale_ * dice_->log_draw(0.001f, 0.12f),
              high = height() * dice_->draw(0.4f, 0.97f);
  const Vec2 p =
      centre + (outline[dice_->rng.below(outline.size())] - centre) * dice_->draw(0, 0.6f);
  const float angle = dice_->chance(0.5f)
                          ? std::atan2(-edge_of(outline, 0).along.y, edge_of(outline, 0).along.x)
                          : dice_->draw(0, kPi);
  put({-width / 2, dice_->chance(0.8f) ? 0 : 0.1f * high, -thick / 2}, {width / 2, high, thick / 2},
      standing(p, cell().floor, angle), "board");
}

}  // namespace

void build_structure(Builder* builder, Dice* dice) {
  Structure structure(builder, dice);
  for (int i = 0; i < static_cast<int>(builder->plan->cells.size()); ++i) structure.build(i);
}

}  // namespace lte::datagen::wild
