// Furniture and things, each of random size, form and material: on y = 0 about the origin, back
// towards −z, unless it says otherwise. Lengths in metres.
#pragma once

#include "datagen/homes/kit.h"

namespace lte::datagen::homes {

// Bedroom (beds.cpp, storage.cpp)
Piece make_bed(Kit* kit, bool two);
Piece make_bedside(Kit* kit);
Piece make_wardrobe(Kit* kit);
Piece make_dresser(Kit* kit);

// Seats (seating.cpp)
Piece make_sofa(Kit* kit, int seats);  ///< one seat: an armchair
Piece make_chair(Kit* kit);
Piece make_stool(Kit* kit);
Piece make_desk_chair(Kit* kit);

// Tables and shelves (tables.cpp, storage.cpp)
Piece make_dining_table(Kit* kit, float width, float depth);
Piece make_coffee_table(Kit* kit);
Piece make_side_table(Kit* kit);
Piece make_desk(Kit* kit);
Piece make_bookshelf(Kit* kit);
Piece make_media_bench(Kit* kit);  ///< with a television
Piece make_console(Kit* kit);

// Kitchen and bathroom (kitchen.cpp, bathroom.cpp)
/// Base units with sink and hob under a worktop. `upper` adds wall units, a hood and a lit strip.
Piece make_kitchen_run(Kit* kit, float length, bool upper);
Piece make_fridge(Kit* kit);
Piece make_tub(Kit* kit);
Piece make_vanity(Kit* kit);
Piece make_toilet(Kit* kit);
Piece make_towel_rail(Kit* kit);  ///< hangs on a wall

// Lamps (lamps.cpp)
Piece make_floor_lamp(Kit* kit);
Piece make_table_lamp(Kit* kit);
/// Hangs from `ceiling_y` so that its lowest point is at `bottom_y`.
Piece make_pendant(Kit* kit, float ceiling_y, float bottom_y);
/// A strip of light along x that hangs on a wall, over a mirror say.
Piece make_strip(Kit* kit, float length);

// Decoration (decor.cpp, plants.cpp). Pictures and mirrors hang: their lower edge is at y = 0.
Piece make_picture(Kit* kit, float width, float height);
Piece make_mirror(Kit* kit, float width, float height);
Piece make_rug(Kit* kit, float width, float depth);
Piece make_curtains(Kit* kit, float opening, float sill, float top);
Piece make_plant(Kit* kit, float height);
Piece make_coat_rack(Kit* kit);

// Things that stand on surfaces (clutter.cpp)
enum class Thing {
  Cup,
  Bowl,
  Bottle,
  Vase,
  Books,
  Candle,
  Fruit,
  Plate,
  Clock,
  Plant,
  Lamp,
  Monitor,
  Laptop,
  Pot,
  Soap
};
Piece make_thing(Kit* kit, Thing thing);

}  // namespace lte::datagen::homes
