#include "datagen/wild/furnishing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "datagen/homes/furniture/furniture.h"
#include "datagen/wild/primitives.h"

namespace lte::datagen::wild {
namespace {

using homes::Piece;
using homes::scaling;
using homes::translation;

class Furnishing {
 public:
  Furnishing(Builder* builder, homes::Kit* kit, Dice* dice)
      : builder_(builder), kit_(kit), dice_(dice), scale_(builder->plan->unit / 4) {}

  void furnish(int index) {
    index_ = index;
    for (size_t e = 0; e < cell().outline.size(); ++e)
      for (const Hole& hole : cell().holes[e])
        if (hole.kind == OpeningKind::Window && dice_->chance(0.25f)) curtains(e, hole);
    const float density = dice_->draw(kShares.pieces_m2[0], kShares.pieces_m2[1]);
    const float wanted = density * area_of(cell().outline) / (scale_ * scale_);
    const int pieces = std::min(kMaxPieces, static_cast<int>(wanted + dice_->draw(0, 1)));
    for (int i = 0; i < pieces; ++i) put(draw_piece());
  }

 private:
  const Cell& cell() const { return builder_->plan->cells[static_cast<size_t>(index_)]; }
  Piece draw_piece();
  Piece kit_piece();
  void recolor(Piece* piece);
  void put(Piece&& piece);
  Affine try_place(const Bounds& bounds);
  void dress(const std::vector<Bounds>& tops, const Affine& at, float size);
  void curtains(size_t edge, const Hole& hole);

  Builder* builder_;
  homes::Kit* kit_;
  Dice* dice_;
  float scale_;
  int index_ = 0;
};

Piece Furnishing::kit_piece() {
  switch (dice_->count(0, 19)) {
    case 0:
      return homes::make_bed(kit_, dice_->chance(0.5f));
    case 1:
      return homes::make_bedside(kit_);
    case 2:
      return homes::make_wardrobe(kit_);
    case 3:
      return homes::make_dresser(kit_);
    case 4:
    case 5:
      return homes::make_sofa(kit_, dice_->count(1, 3));
    case 6:
    case 7:
      return homes::make_chair(kit_);
    case 8:
      return homes::make_stool(kit_);
    case 9:
      return homes::make_desk_chair(kit_);
    case 10:
      return homes::make_dining_table(kit_, dice_->draw(0.9f, 1.8f), dice_->draw(0.7f, 1));
    case 11:
      return homes::make_coffee_table(kit_);
    case 12:
      return homes::make_side_table(kit_);
    case 13:
      return homes::make_desk(kit_);
    case 14:
      return homes::make_bookshelf(kit_);
    case 15:
      return homes::make_media_bench(kit_);
    case 16:
      return homes::make_coat_rack(kit_);
    case 17:
      return homes::make_tub(kit_);
    default:
      return homes::make_plant(kit_, dice_->draw(0.4f, 1.6f));
  }
}

/// Materials of this scene in the place of the kit's, whose albedos lie in a narrower band.
void Furnishing::recolor(Piece* piece) {
  std::map<int, homes::Mesh> meshes;
  for (auto& [material, mesh] : piece->meshes) {
    (void)material;
    homes::append(&meshes[builder_->materials->thing()], mesh, {});
  }
  piece->meshes = std::move(meshes);
}

Piece Furnishing::draw_piece() {
  if (dice_->chance(0.5f))
    return make_primitive(dice_->log_draw(0.15f, 2), builder_->materials, dice_);
  Piece piece = kit_piece();
  if (dice_->chance(0.5f)) recolor(&piece);
  return piece;
}

/// Against a wall, or anywhere at any angle.
Affine Furnishing::try_place(const Bounds& bounds) {
  const Polygon& outline = cell().outline;
  if (dice_->chance(0.5f)) {
    const size_t e = dice_->rng.below(outline.size());
    const float u = edge_of(outline, e).length * dice_->draw(0, 1);
    return edge_frame(cell(), e) * translation({u, 0, 0.02f * scale_ - bounds.low.z});
  }
  const Vec2 corner = outline[dice_->rng.below(outline.size())], centre = centre_of(outline);
  const Vec2 p = centre + (corner - centre) * std::sqrt(dice_->draw(0, 1));
  return standing(p, cell().floor, dice_->draw(0, 2 * kPi));
}

void Furnishing::put(Piece&& piece) {
  const float size = scale_ * dice_->log_draw(0.7f, 1.4f);
  const Bounds bounds = piece.bounds();
  if (bounds.empty() || piece.meshes.empty()) return;
  const Bounds scaled{bounds.low * size, bounds.high * size};
  for (int tries = 0; tries < 8; ++tries) {
    const Affine at = try_place(scaled) * translation({0, 1e-3f * scale_ - scaled.low.y, 0});
    const OrientedBox box = homes::oriented_box(scaled, at);
    if (!builder_->fits(index_, box, 0.004f) || !builder_->is_free(index_, box, 0.01f * scale_))
      continue;
    builder_->taken[static_cast<size_t>(index_)].push_back(box);
    const std::vector<Bounds> tops = piece.tops;
    builder_->add(std::move(piece), at * scaling({size, size, size}));
    dress(tops, at, size);
    return;
  }
}

/// Stands things on the tops of a piece.
void Furnishing::dress(const std::vector<Bounds>& tops, const Affine& at, float size) {
  for (const Bounds& top : tops) {
    if (!dice_->chance(0.5f)) continue;
    for (int i = dice_->count(1, 3); i > 0; --i) {
      Piece thing = dice_->chance(0.6f)
                        ? homes::make_thing(kit_, static_cast<homes::Thing>(dice_->count(0, 14)))
                        : make_primitive(dice_->log_draw(0.05f, 0.3f), builder_->materials, dice_);
      const Bounds own = thing.bounds();
      if (own.empty()) continue;
      const Vec3 room = top.extent() - own.extent();
      if (room.x < 0 || room.z < 0) continue;
      const Vec3 corner =
          top.low - own.low + Vec3{room.x * dice_->draw(0, 1), 0, room.z * dice_->draw(0, 1)};
      const Affine place = translation((corner + Vec3{0, 1e-3f, 0}) * size);
      const OrientedBox box = homes::oriented_box({own.low * size, own.high * size}, at * place);
      if (!builder_->fits(index_, box, 0.002f)) continue;
      builder_->add(std::move(thing), at * place * scaling({size, size, size}));
    }
  }
}

void Furnishing::curtains(size_t edge, const Hole& hole) {
  const float top = hole.top.front().y - cell().floor;
  Piece piece = homes::make_curtains(kit_, (hole.u1 - hole.u0) / scale_,
                                     (hole.low - cell().floor) / scale_, top / scale_);
  const Bounds b = piece.bounds();
  const Bounds scaled{b.low * scale_, b.high * scale_};
  const Affine at = edge_frame(cell(), edge) *
                    translation({0.5f * (hole.u0 + hole.u1), 0, 0.02f * scale_ - scaled.low.z});
  const OrientedBox box = homes::oriented_box(scaled, at);
  if (!builder_->fits(index_, box, 0.004f) || !builder_->is_free(index_, box, 0.005f)) return;
  builder_->taken[static_cast<size_t>(index_)].push_back(box);
  builder_->add(std::move(piece), at * scaling({scale_, scale_, scale_}));
}

}  // namespace

void furnish(Builder* builder, homes::Kit* kit, Dice* dice) {
  Furnishing furnishing(builder, kit, dice);
  for (int i = 0; i < static_cast<int>(builder->plan->cells.size()); ++i) furnishing.furnish(i);
}

}  // namespace lte::datagen::wild
