// Tables, desks and consoles.
#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

constexpr float kClear = 0.5f;  ///< metres free above a table top

/// A rectangular or a round top on legs or on a foot.
void add_table(Kit* kit, Piece* table, float width, float depth, float top, float thick, int wood) {
  const float x = width / 2, z = depth / 2;
  const bool round = width == depth && kit->chance(0.6f);
  if (round) {
    kit->turned(table,
                {{0, top - thick},
                 {x - 0.02f, top - thick},
                 {x, top - thick / 2},
                 {x - 0.004f, top},
                 {0, top}},
                wood, {}, false, 1);
    kit->turned(table,
                {{0, 0},
                 {0.5f * x, 0},
                 {0.48f * x, 0.02f},
                 {0.1f, 0.05f},
                 {0.04f, 0.12f},
                 {0.035f, top - 0.1f},
                 {0.1f, top - thick},
                 {0, top - thick}},
                wood, {}, false, 2);
    const float r = 0.64f * x;
    table->tops.push_back({{-r, top, -r}, {r, top + kClear, r}});
    return;
  }
  kit->block(table, {-x, top - thick, -z}, {x, top, z}, wood, std::min(0.4f * thick, 0.012f));
  const float inset = kit->draw(0.01f, 0.06f);
  const int style = kit->count(0, 2);
  kit->legs(table, {-x + inset, 0, -z + inset}, {x - inset, top - thick, z - inset},
            style == 2 ? 0.045f : kit->draw(0.05f, 0.08f), static_cast<Kit::Legs>(style),
            style == 2 ? kit->palette->metal() : wood);
  if (style != 2 && top > 0.5f) {  // aprons
    const float y0 = top - thick - 0.08f, y1 = top - thick, in = inset + 0.02f;
    for (const float side : {-1.0f, 1.0f}) {
      kit->block(table, {-x + in + 0.05f, y0, side * (z - in) - 0.01f},
                 {x - in - 0.05f, y1, side * (z - in) + 0.01f}, wood, 0.002f);
      kit->block(table, {side * (x - in) - 0.01f, y0, -z + in + 0.05f},
                 {side * (x - in) + 0.01f, y1, z - in - 0.05f}, wood, 0.002f);
    }
  }
  table->tops.push_back({{-x + 0.03f, top, -z + 0.03f}, {x - 0.03f, top + kClear, z - 0.03f}});
}

}  // namespace

Piece make_dining_table(Kit* kit, float width, float depth) {
  Piece table;
  table.name = "dining table";
  add_table(kit, &table, width, depth, kit->draw(0.73f, 0.76f), kit->draw(0.03f, 0.045f),
            kit->palette->wood());
  return table;
}

Piece make_coffee_table(Kit* kit) {
  Piece table;
  table.name = "coffee table";
  const float width = kit->draw(0.7f, 1.15f),
              depth = kit->chance(0.3f) ? width : kit->draw(0.5f, 0.65f);
  const float top = kit->draw(0.36f, 0.44f);
  add_table(kit, &table, width, depth, top, kit->draw(0.025f, 0.05f), kit->palette->wood());
  return table;
}

Piece make_side_table(Kit* kit) {
  Piece table;
  table.name = "side table";
  const float width = kit->draw(0.4f, 0.5f);
  add_table(kit, &table, width, width, kit->draw(0.5f, 0.6f), 0.025f, kit->palette->wood());
  return table;
}

Piece make_desk(Kit* kit) {
  Piece desk;
  desk.name = "desk";
  const float x = kit->draw(0.6f, 0.85f), z = kit->draw(0.32f, 0.4f), top = kit->draw(0.73f, 0.76f);
  const int wood = kit->palette->wood(), front = kit->palette->front();
  kit->block(&desk, {-x, top - 0.03f, -z}, {x, top, z}, wood, 0.006f);
  const float pedestal = kit->draw(0.36f, 0.44f);
  kit->cabinet(&desk, {x - pedestal - 0.02f, 0, -z + 0.02f}, {x - 0.02f, top - 0.031f, z - 0.03f},
               1, 3, wood, front, kit->count(0, 1));
  for (const float end : {-z + 0.05f, z - 0.05f})
    kit->block(&desk, {-x + 0.02f, 0, end - 0.025f}, {-x + 0.07f, top - 0.03f, end + 0.025f}, wood);
  kit->block(&desk, {-x + 0.05f, top - 0.33f, -z + 0.03f},
             {x - pedestal - 0.02f, top - 0.03f, -z + 0.045f}, wood, 0.002f);
  desk.tops.push_back({{-x + 0.03f, top, -z + 0.03f}, {x - 0.03f, top + 0.6f, z - 0.05f}});
  return desk;
}

Piece make_console(Kit* kit) {
  Piece console;
  console.name = "console";
  const float width = kit->draw(0.7f, 1.0f), depth = kit->draw(0.26f, 0.32f);
  add_table(kit, &console, width, depth, kit->draw(0.78f, 0.86f), 0.03f, kit->palette->front());
  return console;
}

}  // namespace lte::datagen::homes
