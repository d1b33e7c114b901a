// Groups of things that several types of room have, and things on surfaces.
#include "datagen/homes/furnish.h"

#include <algorithm>
#include <cmath>

#include "datagen/common/parts.h"

namespace lte::datagen::homes {
namespace {

constexpr float kThingGap = 0.015f;

Asset proxy(float width, float height, float depth) {
  Asset asset;
  asset.bounds = {{-width / 2, 0, 0}, {width / 2, height, depth}};
  asset.solids = {asset.bounds};
  return asset;
}

}  // namespace

void Furnisher::furnish() {
  curtains();
  switch (placer_.type()) {
    case RoomType::Bedroom:
      bedroom();
      break;
    case RoomType::Living:
      living_room();
      break;
    case RoomType::Kitchen:
      kitchen();
      break;
    case RoomType::Bathroom:
      bathroom();
      break;
    case RoomType::Study:
      study();
      break;
    case RoomType::Dining:
      dining_room();
      break;
    case RoomType::Corridor:
      corridor();
      break;
  }
}

std::optional<int> Furnisher::put_at_wall(Piece&& piece, float front, bool centred) {
  PlaceOptions options;
  options.front = front;
  return put(std::move(piece), [&](const Asset& a) {
    return placer_.against_wall(a, placer_.all_sides(), centred, options);
  });
}

std::optional<int> Furnisher::put_on_wall(Piece&& piece, Side side, float along, float y) {
  return put(std::move(piece),
             [&](const Asset& a) { return placer_.on_wall(a, side, along, y, {}); });
}

std::optional<int> Furnisher::put_in_corner(Piece&& piece) {
  return put(std::move(piece), [&](const Asset& a) { return placer_.in_corner(a, {}); });
}

std::vector<Side> Furnisher::sides_without(OpeningKind kind) {
  std::vector<Side> sides = placer_.all_sides();
  std::stable_partition(sides.begin(), sides.end(),
                        [&](Side s) { return !placer_.has_opening(s, kind); });
  return sides;
}

std::pair<Side, float> Furnisher::wall_of(int piece) const {
  const Affine at = placer_.where(piece);
  const Vec3 back = at.vector({0, 0, -1});
  const Side side = back.x < -0.5f   ? Side::NegX
                    : back.x > 0.5f  ? Side::PosX
                    : back.z < -0.5f ? Side::NegZ
                                     : Side::PosZ;
  return {side, along_z(side) ? at.m[2][3] : at.m[0][3]};
}

void Furnisher::curtains() {
  const RoomType type = placer_.type();
  const bool cloth = type != RoomType::Kitchen && type != RoomType::Bathroom && kit_->chance(0.7f);
  for (const Opening& o : stage_->plan().floor.openings_of(placer_.room())) {
    if (o.kind != OpeningKind::Window || !cloth || o.top + 0.16f > placer_.height()) continue;
    Piece piece = make_curtains(kit_, o.to - o.from, o.bottom, o.top);
    const Asset outline = Stage::outline(piece);
    const Affine at = placer_.at_wall(outline, o.side, (o.from + o.to) / 2, outline.bounds.low.z);
    bool clear = placer_.inside(oriented_box(outline.bounds, at), 0);
    for (const Opening& other : stage_->plan().floor.openings_of(placer_.room()))
      if (other.kind != OpeningKind::Window)
        clear &=
            apart(oriented_box(outline.bounds, at), opening_zone(stage_->plan().floor, other), 0);
    const PlacedPiece mine = placed(outline, placer_.room(), at, -1);
    for (const PlacedPiece& other : stage_->plan().pieces)
      clear &= other.room != placer_.room() || apart(mine.box, other.box, 0.01f);
    if (clear) stage_->fill(stage_->place(outline, placer_.room(), at), std::move(piece));
  }
}

void Furnisher::pictures(int most) {
  const int count = kit_->count(most > 1 ? 1 : 0, most);
  for (int i = 0; i < count; ++i) {
    const float w = kit_->draw(0.3f, 0.9f), h = w * kit_->draw(0.7f, 1.35f);
    const float y = 1.52f - h / 2 + kit_->draw(-0.05f, 0.1f);
    const auto index = placer_.on_wall(proxy(w, h, 0.036f), y, {});
    if (index) stage_->fill(*index, make_picture(kit_, w, h));
  }
}

float Furnisher::rug(const Affine& at, float width, float depth) {
  Piece piece = make_rug(kit_, width, depth);
  PlaceOptions options;
  options.flat = true;
  const float high = piece.bounds().high.y;
  const auto index =
      put(std::move(piece), [&](const Asset& a) { return placer_.try_at(a, at, options); });
  return index ? high + 0.0005f : 0.0f;
}

void Furnisher::plants(int most) {
  const int count = kit_->count(0, most);
  for (int i = 0; i < count; ++i) put_in_corner(make_plant(kit_, kit_->draw(0.6f, 1.4f)));
}

void Furnisher::shelf() {
  Piece piece = make_bookshelf(kit_);
  const std::vector<Bounds> tops = piece.tops;
  if (const auto index = put_at_wall(std::move(piece), 0.45f))
    dress(*index, tops, {Thing::Vase, Thing::Plant, Thing::Books, Thing::Clock}, 0.6f);
}

void Furnisher::reading_corner() {
  PlaceOptions options;
  options.front = 0.4f;
  const auto chair =
      put(make_sofa(kit_, 1), [&](const Asset& a) { return placer_.in_corner(a, options); });
  if (!chair) return;
  const float half = stage_->plan().pieces[static_cast<size_t>(*chair)].box.half.x;
  for (const float side : {1.0f, -1.0f}) {
    Piece lamp = make_floor_lamp(kit_);
    const Affine at = placer_.where(*chair) * translation({side * (half + 0.27f), 0, -0.1f});
    if (put(std::move(lamp), [&](const Asset& a) { return placer_.try_at(a, at, {}); })) return;
  }
}

void Furnisher::chairs_around(const Affine& table, float width, float depth) {
  Piece piece = make_chair(kit_);
  const Asset chair = stage_->load(std::move(piece));
  PlaceOptions options;
  options.nests = true;
  const int long_side = std::max(1, static_cast<int>(width / 0.62f)),
            short_side = depth > 0.78f ? 1 : 0;
  const auto seat = [&](float x, float z, double degrees) {
    if (!kit_->chance(0.9f)) return;
    // Its front under the table's edge, and a little askew, as people leave it.
    const Affine at = table * placement(degrees + kit_->draw(-9, 9), {x, 0, z});
    placer_.try_at(chair, at, options);
  };
  const float out = kit_->draw(0.1f, 0.2f);
  for (int i = 0; i < long_side; ++i) {
    const float x = width * ((static_cast<float>(i) + 0.5f) / static_cast<float>(long_side) - 0.5f);
    seat(x, depth / 2 + out, 180);
    seat(x, -depth / 2 - out, 0);
  }
  for (int i = 0; i < short_side; ++i) {
    seat(width / 2 + out, 0, 270);
    seat(-width / 2 - out, 0, 90);
  }
}

bool Furnisher::dining_set(float width, float depth, bool with_rug) {
  Piece table = make_dining_table(kit_, width, depth);
  const std::vector<Bounds> tops = table.tops;
  const Asset outline = Stage::outline(table);
  Asset room_needed = outline;  // with the chairs pulled back
  room_needed.bounds.low = room_needed.bounds.low - Vec3{0.4f, 0, 0.4f};
  room_needed.bounds.high = room_needed.bounds.high + Vec3{0.4f, 0, 0.4f};
  std::optional<Affine> spot;
  const Rect& r = placer_.inner();
  for (int attempt = 0; attempt < 30 && !spot; ++attempt) {
    const float t = static_cast<float>(attempt) / 30;
    const Vec3 at{r.x0 + r.width() * (0.5f + t * (kit_->draw(0, 1) - 0.5f)), 0,
                  r.z0 + r.depth() * (0.5f + t * (kit_->draw(0, 1) - 0.5f))};
    const bool turned = (r.depth() > r.width()) != (attempt % 3 == 2);
    const Affine pose = placement(turned ? 90 : 0, at);
    if (placer_.fits(room_needed, pose, {})) spot = pose;
  }
  if (!spot) return false;
  Affine pose = *spot;
  if (with_rug) pose.m[1][3] = rug(pose, width + 1.1f, depth + 1.1f);
  const auto index =
      put(std::move(table), [&](const Asset& a) { return placer_.try_at(a, pose, {}); });
  if (!index) return false;
  chairs_around(pose, width, depth);
  dress(*index, tops,
        {Thing::Fruit, Thing::Plate, Thing::Cup, Thing::Vase, Thing::Candle, Thing::Bottle,
         Thing::Bowl});
  if (kit_->chance(0.75f)) {
    Affine above = pose;
    above.m[1][3] = 0;
    put(make_pendant(kit_, placer_.height(), std::min(1.65f, placer_.height() - 0.7f)),
        [&](const Asset& a) { return placer_.try_at(a, above, {}); });
  }
  return true;
}

bool Furnisher::stand(int piece, const Bounds& top, Thing kind, bool centred) {
  Piece thing = make_thing(kit_, kind);
  const Bounds local = thing.bounds();
  const bool faces = kind == Thing::Monitor || kind == Thing::Laptop || kind == Thing::Clock;
  const Affine parent = placer_.where(piece);
  for (int attempt = 0; attempt < 6; ++attempt) {
    const Affine turn = rotation(1, faces ? kit_->draw(-12, 12) : kit_->draw(0, 360));
    const Bounds box = transformed(local, turn);
    const Vec3 room = top.extent() - box.extent();
    if (room.x < 0 || room.y < 0 || room.z < 0) return false;
    const float u = centred && attempt == 0 ? 0.5f : kit_->draw(0, 1), v = kit_->draw(0, 1);
    const Vec3 at = top.low - box.low + Vec3{u * room.x, 0.0005f, v * room.z};
    const Affine to_world = parent * translation({at.x, at.y, at.z}) * turn;
    const PlacedPiece mine = placed(Stage::outline(thing), placer_.room(), to_world, piece);
    bool clear = placer_.clear_of_openings(mine.box, false);
    for (const PlacedPiece& other : stage_->plan().pieces)
      if (&other != &stage_->plan().pieces[static_cast<size_t>(piece)] &&
          other.room == placer_.room())
        clear &= apart(mine.box, other.box, kThingGap);
    if (!clear) continue;
    const int index = stage_->place(Stage::outline(thing), placer_.room(), to_world, piece);
    stage_->fill(index, std::move(thing));
    return true;
  }
  return false;
}

void Furnisher::dress(int piece, const std::vector<Bounds>& tops, const std::vector<Thing>& kinds,
                      float density) {
  for (const Bounds& top : tops) {
    const float area = top.extent().x * top.extent().z;
    const int things = static_cast<int>(
        std::lround(density * clutter_ * (1 + 9 * std::sqrt(area)) * kit_->draw(0.5f, 1.1f)));
    for (int i = 0; i < things; ++i)
      stand(piece, top, kinds[kit_->rng.below(kinds.size())], i == 0);
  }
}

}  // namespace lte::datagen::homes
