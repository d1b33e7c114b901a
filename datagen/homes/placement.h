// Rules for placing things in a room: they keep clear of one another, of doors, of windows above
// their sills and of ceiling lights, and one can still walk from every door to every other.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "datagen/homes/stage.h"
#include "datagen/homes/walkway.h"

namespace lte::datagen::homes {

struct PlaceOptions {
  float front = 0;       ///< metres kept free in front of the piece
  bool nests = false;    ///< parts may reach under or over other pieces' parts, as chairs do
  bool flat = false;     ///< a rug: only other flat things and door sills are in its way
  bool keep_lit = true;  ///< stays clear of ceiling lights, if it is tall
};

class Placer {
 public:
  Placer(Stage* stage, int room, Rng* rng);

  const Rect& inner() const { return inner_; }
  float height() const { return stage_->plan().floor.height; }
  RoomType type() const { return stage_->plan().floor.rooms[static_cast<size_t>(room_)].type; }
  int room() const { return room_; }

  /// Checks every rule but that of the walkway, which try_at() checks last since it costs most.
  bool fits(const Asset& asset, const Affine& at, const PlaceOptions& options) const;
  /// Places the asset there if it fits.
  /// @return  its index in the plan
  std::optional<int> try_at(const Asset& asset, const Affine& at, const PlaceOptions& options);

  /// Places it with its back to one of the walls in `sides`; if `centred`, the middle of the wall
  /// is tried first.
  std::optional<int> against_wall(const Asset& asset, const std::vector<Side>& sides, bool centred,
                                  const PlaceOptions& options);
  std::optional<int> in_corner(const Asset& asset, const PlaceOptions& options);
  /// Places it somewhere in the inner `share` of the room.
  std::optional<int> anywhere(const Asset& asset, float share, const PlaceOptions& options);
  /// Hangs it on a wall with its lower edge at y, clear of doors, windows and things in front of
  /// it.
  std::optional<int> on_wall(const Asset& asset, float y, const PlaceOptions& options);
  std::optional<int> on_wall(const Asset& asset, Side side, float along, float y,
                             const PlaceOptions& options);

  /// The frame of a thing whose back is `gap` away from a wall and whose middle is at `along`.
  Affine at_wall(const Asset& asset, Side side, float along, float gap = kWallGap) const;
  std::vector<Side> all_sides();  ///< in random order
  bool has_opening(Side side, OpeningKind kind) const;
  Affine where(int piece) const {
    return stage_->plan().pieces[static_cast<size_t>(piece)].to_world;
  }

  bool inside(const OrientedBox& box, float gap) const;
  /// Whether it is clear of all doors and windows. Flat things may lie before a window.
  bool clear_of_openings(const OrientedBox& box, bool flat) const;

 private:
  bool clear_of_lights(const OrientedBox& box) const;
  bool clear_of_pieces(const Asset& asset, const Affine& at, const PlaceOptions& options) const;
  bool walkable_with(const OrientedBox& box) const;

  Stage* stage_;
  int room_;
  Rng* rng_;
  Rect inner_;
  std::vector<Opening> openings_;
  std::vector<OrientedBox> zones_;  ///< kept free in front of furniture
  WalkGrid walk_;
  std::vector<Vec2> steps_;
};

/// The box in front of an opening, within its room, that must stay free.
OrientedBox opening_zone(const FloorPlan& plan, const Opening& opening);

}  // namespace lte::datagen::homes
