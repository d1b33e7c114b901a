#include "datagen/homes/placement.h"

#include <algorithm>
#include <cmath>

#include "datagen/common/parts.h"

namespace lte::datagen::homes {
namespace {

constexpr int kAttempts = 30;
constexpr float kGap = 0.02f;         // metres between pieces
constexpr float kNestedGap = 0.008f;  // metres between parts of pieces that nest
constexpr float kFlat = 0.03f;        // metres; what is lower counts as floor

OrientedBox straight(const Bounds& b) { return oriented_box(b, {}); }

/// How often placement() (parts.h) turns a thing by 90 degrees so that its back is to a wall: the
/// back faces −z, −x, +z, +x in turn.
int quarter_of(Side side) {
  static constexpr int kQuarters[] = {1, 3, 0, 2};
  return kQuarters[static_cast<size_t>(side)];
}

}  // namespace

OrientedBox opening_zone(const FloorPlan& plan, const Opening& opening) {
  const bool window = opening.kind == OpeningKind::Window;
  const float deep = window ? kWindowGap : kDoorClearance, margin = window ? 0.02f : 0.08f;
  const float face = plan.face(opening.room, opening.side);
  const bool high = opening.side == Side::PosX || opening.side == Side::PosZ;
  const float a = high ? face - deep : face, b = high ? face : face + deep;
  const float low = window ? opening.bottom - 0.05f : 0.0f, from = opening.from - margin,
              to = opening.to + margin;
  return along_z(opening.side) ? straight({{a, low, from}, {b, opening.top, to}})
                               : straight({{from, low, a}, {to, opening.top, b}});
}

Placer::Placer(Stage* stage, int room, Rng* rng)
    : stage_(stage),
      room_(room),
      rng_(rng),
      inner_(stage->plan().floor.rooms[static_cast<size_t>(room)].inner),
      openings_(stage->plan().floor.openings_of(room)),
      walk_(inner_),
      steps_(door_steps(stage->plan().floor, room)) {}

bool Placer::inside(const OrientedBox& box, float gap) const {
  const Bounds b = bounds_of(box);
  constexpr float kSlack = 1e-4f;
  return b.low.x >= inner_.x0 + gap - kSlack && b.high.x <= inner_.x1 - gap + kSlack &&
         b.low.z >= inner_.z0 + gap - kSlack && b.high.z <= inner_.z1 - gap + kSlack &&
         b.high.y <= height() + kSlack;
}

bool Placer::clear_of_openings(const OrientedBox& box, bool flat) const {
  for (const Opening& opening : openings_) {
    if (flat && opening.kind == OpeningKind::Window) continue;
    if (!apart(box, opening_zone(stage_->plan().floor, opening), 0)) return false;
  }
  return true;
}

bool Placer::clear_of_lights(const OrientedBox& box) const {
  if (box.high <= height() - kLightHeadroom) return true;
  for (const Bounds& light : stage_->plan().ceiling_lights) {
    Bounds zone = light;
    zone.low = zone.low - Vec3{kLightTallDistance, kLightHeadroom, kLightTallDistance};
    zone.high = zone.high + Vec3{kLightTallDistance, 0, kLightTallDistance};
    if (!apart(box, straight(zone), 0)) return false;
  }
  return true;
}

bool Placer::clear_of_pieces(const Asset& asset, const Affine& at,
                             const PlaceOptions& options) const {
  const PlacedPiece mine = placed(asset, room_, at, -1);
  for (const PlacedPiece& other : stage_->plan().pieces) {
    if (other.room != room_) continue;
    const bool other_flat = other.box.high < kFlat;
    if (options.flat != other_flat) {  // things stand beside a rug, or on it with all their feet
      if (!apart(mine.box, other.box, 0)) return false;
      continue;
    }
    if (apart(mine.box, other.box, kGap)) continue;
    if (!options.nests && !other.by_parts) return false;
    for (const OrientedBox& a : mine.solids)
      for (const OrientedBox& b : other.solids)
        if (!apart(a, b, kNestedGap)) return false;
  }
  return true;
}

bool Placer::walkable_with(const OrientedBox& box) const {
  WalkGrid grid = walk_;
  grid.block(box);
  return grid.connects(steps_);
}

bool Placer::fits(const Asset& asset, const Affine& at, const PlaceOptions& options) const {
  const OrientedBox box = oriented_box(asset.bounds, at);
  if (!inside(box, asset.bounds.low.y > 0.3f ? 0.0f : kWallGap)) return false;
  if (!clear_of_openings(box, options.flat)) return false;
  if (options.keep_lit && !clear_of_lights(box)) return false;
  if (!options.flat)
    for (const OrientedBox& zone : zones_)
      if (!options.nests && !apart(box, zone, 0)) return false;
  return clear_of_pieces(asset, at, options);
}

std::optional<int> Placer::try_at(const Asset& asset, const Affine& at,
                                  const PlaceOptions& options) {
  if (!fits(asset, at, options)) return std::nullopt;
  const OrientedBox box = oriented_box(asset.bounds, at);
  if (options.front > 0) {
    Bounds front = asset.bounds;
    front.low = {front.low.x, 0.05f, front.high.z};
    front.high = {front.high.x, 1.8f, front.low.z + options.front};
    const OrientedBox zone = oriented_box(front, at);
    if (!inside(zone, 0)) return std::nullopt;
    for (const PlacedPiece& other : stage_->plan().pieces)
      if (other.room == room_ && !apart(zone, other.box, 0)) return std::nullopt;
    if (!walkable_with(box)) return std::nullopt;
    zones_.push_back(zone);
  } else if (!walkable_with(box)) {
    return std::nullopt;
  }
  walk_.block(box);
  return stage_->place(asset, room_, at);
}

Affine Placer::at_wall(const Asset& asset, Side side, float along, float gap) const {
  const int quarter = quarter_of(side);
  const float back = asset.bounds.low.z;  // local; the wall is at back − gap
  const float face = stage_->plan().floor.face(room_, side);
  const float out = gap - back;
  const bool high = side == Side::PosX || side == Side::PosZ;
  const float across = high ? face - out : face + out;
  const Vec3 at = along_z(side) ? Vec3{across, 0, along} : Vec3{along, 0, across};
  return placement(90.0 * quarter, at);
}

std::vector<Side> Placer::all_sides() {
  std::vector<Side> sides(std::begin(kSides), std::end(kSides));
  for (size_t i = sides.size(); i > 1; --i) std::swap(sides[i - 1], sides[rng_->below(i)]);
  return sides;
}

bool Placer::has_opening(Side side, OpeningKind kind) const {
  return std::any_of(openings_.begin(), openings_.end(),
                     [&](const Opening& o) { return o.side == side && o.kind == kind; });
}

std::optional<int> Placer::against_wall(const Asset& asset, const std::vector<Side>& sides,
                                        bool centred, const PlaceOptions& options) {
  const float half = asset.bounds.extent().x / 2 + kWallGap;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Side side = sides[static_cast<size_t>(attempt) % sides.size()];
    const float low = (along_z(side) ? inner_.z0 : inner_.x0) + half;
    const float high = (along_z(side) ? inner_.z1 : inner_.x1) - half;
    if (high < low) continue;
    const bool first = attempt < static_cast<int>(sides.size());
    const float t = centred && first ? 0.5f : rng_->uniform();
    if (const auto index = try_at(asset, at_wall(asset, side, low + t * (high - low)), options))
      return index;
  }
  return std::nullopt;
}

std::optional<int> Placer::in_corner(const Asset& asset, const PlaceOptions& options) {
  const float half = asset.bounds.extent().x / 2 + kWallGap;
  for (const Side side : all_sides()) {
    const float low = (along_z(side) ? inner_.z0 : inner_.x0) + half;
    const float high = (along_z(side) ? inner_.z1 : inner_.x1) - half;
    if (high < low) continue;
    const bool start = rng_->below(2) == 0;
    for (const float along : {start ? low : high, start ? high : low})
      if (const auto index = try_at(asset, at_wall(asset, side, along), options)) return index;
  }
  return std::nullopt;
}

std::optional<int> Placer::anywhere(const Asset& asset, float share, const PlaceOptions& options) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const float t = share * static_cast<float>(attempt + 1) / kAttempts;
    const float u = 0.5f + t * (rng_->uniform() - 0.5f), v = 0.5f + t * (rng_->uniform() - 0.5f);
    const Vec3 at{inner_.x0 + u * inner_.width(), 0, inner_.z0 + v * inner_.depth()};
    const double degrees = 90.0 * static_cast<double>(rng_->below(4));
    if (const auto index = try_at(asset, placement(degrees, at), options)) return index;
  }
  return std::nullopt;
}

std::optional<int> Placer::on_wall(const Asset& asset, Side side, float along, float y,
                                   const PlaceOptions& options) {
  Affine at = at_wall(asset, side, along, 0.001f);
  at.m[1][3] = y;
  const OrientedBox box = oriented_box(asset.bounds, at);
  if (!inside(box, 0) || !clear_of_openings(box, false)) return std::nullopt;
  if (options.keep_lit && !clear_of_lights(box)) return std::nullopt;
  for (const PlacedPiece& other : stage_->plan().pieces)
    if (other.room == room_ && !apart(box, other.box, kGap)) return std::nullopt;
  return stage_->place(asset, room_, at);
}

std::optional<int> Placer::on_wall(const Asset& asset, float y, const PlaceOptions& options) {
  const float half = asset.bounds.extent().x / 2 + 0.05f;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Side side = kSides[rng_->below(4)];
    const float low = (along_z(side) ? inner_.z0 : inner_.x0) + half;
    const float high = (along_z(side) ? inner_.z1 : inner_.x1) - half;
    const float t = rng_->uniform();
    if (high < low) continue;
    if (const auto index = on_wall(asset, side, low + t * (high - low), y, options)) return index;
  }
  return std::nullopt;
}

}  // namespace lte::datagen::homes
