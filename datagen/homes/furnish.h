// Furnishes the rooms of a home: what stands where, by type of room.
#pragma once

#include <initializer_list>
#include <optional>
#include <vector>

#include "datagen/homes/furniture/furniture.h"
#include "datagen/homes/placement.h"

namespace lte::datagen::homes {

/// One room while it is furnished: pieces, where they go, and what lies on them.
class Furnisher {
 public:
  Furnisher(Stage* stage, Kit* kit, int room, float clutter)
      : stage_(stage), kit_(kit), clutter_(clutter), placer_(stage, room, &kit->rng) {}

  void furnish();

 private:
  // One for each type of room, in furnish_rooms.cpp.
  void bedroom();
  void living_room();
  void kitchen();
  void bathroom();
  void study();
  void dining_room();
  void corridor();

  // Groups of things that several rooms have, in furnish.cpp.
  void curtains();
  void pictures(int most);
  /// Places a table with chairs around it and a pendant above, on a rug if `rug` is set.
  /// @return  false if there is no room for it
  bool dining_set(float width, float depth, bool rug);
  void chairs_around(const Affine& table, float width, float depth);
  void plants(int most);
  void shelf();
  void reading_corner();
  /// Lays a rug of about this size whose middle is at `at`.
  /// @return  the height at which things stand on it; 0 if there is no room for the rug
  float rug(const Affine& at, float width, float depth);

  /// Places a piece by `attempt(outline)`. It gets triangles only if that finds a place.
  template <typename Attempt>
  std::optional<int> put(Piece&& piece, const Attempt& attempt) {
    const Asset outline = Stage::outline(piece);
    const std::optional<int> index = attempt(outline);
    if (index) stage_->fill(*index, std::move(piece));
    return index;
  }
  std::optional<int> put_at_wall(Piece&& piece, float front, bool centred = false);
  std::optional<int> put_on_wall(Piece&& piece, Side side, float along, float y);
  std::optional<int> put_in_corner(Piece&& piece);

  /// Stands things of these kinds on the tops of a placed piece.
  void dress(int piece, const std::vector<Bounds>& tops, const std::vector<Thing>& kinds,
             float density = 1);
  bool stand(int piece, const Bounds& top, Thing kind, bool centred);
  std::vector<Side> sides_without(OpeningKind kind);
  /// Where a placed piece is along its wall, and which wall that is.
  std::pair<Side, float> wall_of(int piece) const;

  Stage* stage_;
  Kit* kit_;
  float clutter_;
  Placer placer_;
};

}  // namespace lte::datagen::homes
