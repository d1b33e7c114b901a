// Wardrobes, dressers, shelves, benches.
#include <algorithm>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {

Piece make_bedside(Kit* kit) {
  Piece piece;
  piece.name = "bedside";
  const float x = kit->draw(0.2f, 0.26f), z = kit->draw(0.18f, 0.22f),
              top = kit->draw(0.45f, 0.55f);
  const int body = kit->palette->front(), style = kit->count(0, 1);
  kit->cabinet(&piece, {-x, 0, -z}, {x, top - 0.02f, z}, 1, kit->count(1, 3), body, body, style);
  kit->block(&piece, {-x - 0.01f, top - 0.02f, -z}, {x + 0.01f, top, z + 0.01f}, body, 0.006f);
  piece.tops.push_back({{-x + 0.01f, top, -z + 0.01f}, {x - 0.01f, top + 0.6f, z - 0.01f}});
  return piece;
}

Piece make_wardrobe(Kit* kit) {
  Piece piece;
  piece.name = "wardrobe";
  const int doors = kit->count(2, 4);
  const float x = 0.24f * static_cast<float>(doors) + kit->draw(0, 0.1f),
              high = kit->draw(1.95f, 2.15f);
  kit->cabinet(&piece, {-x, 0, -0.3f}, {x, high, 0.3f}, doors, 0, kit->palette->front(),
               kit->palette->front(), kit->count(0, 5));
  return piece;
}

Piece make_dresser(Kit* kit) {
  Piece piece;
  piece.name = "dresser";
  const float x = kit->draw(0.4f, 0.75f), top = kit->draw(0.75f, 0.95f), z = 0.23f;
  const int body = kit->palette->front();
  kit->cabinet(&piece, {-x, 0, -z}, {x, top - 0.025f, z}, x > 0.55f ? 2 : 1, kit->count(3, 4), body,
               kit->palette->front(), kit->count(0, 1));
  kit->block(&piece, {-x - 0.01f, top - 0.025f, -z}, {x + 0.01f, top, z + 0.012f}, body, 0.008f);
  piece.tops.push_back({{-x + 0.02f, top, -z + 0.02f}, {x - 0.02f, top + 0.6f, z - 0.02f}});
  return piece;
}

Piece make_bookshelf(Kit* kit) {
  Piece piece;
  piece.name = "bookshelf";
  const float x = kit->draw(0.38f, 0.6f), z = kit->draw(0.14f, 0.17f), high = kit->draw(1.1f, 2.1f),
              board = 0.022f;
  const int wood = kit->chance(0.7f) ? kit->palette->wood() : kit->palette->lacquer();
  for (const float side : {-x, x - board})
    kit->block(&piece, {side, 0, -z}, {side + board, high, z}, wood, 0.002f);
  kit->block(&piece, {-x + board, 0.04f, -z}, {x - board, high, -z + 0.008f}, wood, 0.001f);
  const int rows = std::max(3, static_cast<int>(high / kit->draw(0.32f, 0.38f)));
  const float pitch = (high - 0.06f - board) / static_cast<float>(rows);
  for (int row = 0; row <= rows; ++row) {
    const float y = 0.06f + pitch * static_cast<float>(row);
    kit->block(&piece, {-x + board, y, -z + 0.008f}, {x - board, y + board, z - 0.004f}, wood,
               0.002f);
    if (row == rows) break;
    const float clear = pitch - board, x0 = -x + board + 0.004f, x1 = x - board - 0.004f;
    const float split = kit->chance(0.6f) ? x1 : x0 + kit->draw(0.35f, 0.7f) * (x1 - x0);
    const Vec3 thing_at{(split + x1) / 2, y + board, 0.01f};
    kit->book_row(&piece, x0, split, y + board, clear, -z + 0.012f, z - 0.01f);
    if (x1 - split < 0.24f) continue;
    const Thing kinds[] = {Thing::Bowl, Thing::Vase, Thing::Cup, Thing::Candle};
    Piece thing = make_thing(kit, kinds[kit->count(0, 3)]);
    const Vec3 size = thing.bounds().extent();
    if (size.y < clear - 0.01f &&
        std::max(size.x, size.z) < std::min(x1 - split - 0.01f, 2 * z - 0.04f))
      piece.add(thing, translation(thing_at));
  }
  if (high < 1.5f)
    piece.tops.push_back(
        {{-x + 0.02f, 0.06f + pitch * static_cast<float>(rows) + board, -z + 0.02f},
         {x - 0.02f, high + 0.5f, z - 0.02f}});
  return piece;
}

Piece make_media_bench(Kit* kit) {
  Piece piece;
  piece.name = "media bench";
  const float x = kit->draw(0.7f, 1.0f), top = kit->draw(0.42f, 0.52f), z = 0.21f;
  kit->cabinet(&piece, {-x, 0, -z}, {x, top, z}, kit->count(2, 4), kit->chance(0.5f) ? 1 : 0,
               kit->palette->wood(), kit->palette->front(), kit->count(0, 1));
  const int black = kit->palette->black();
  const float half = kit->draw(0.45f, std::min(0.7f, x - 0.02f)), high = half * 1.15f,
              y = top + 0.06f;
  kit->block(&piece, {-0.18f, top, -0.1f}, {0.18f, top + 0.012f, 0.08f}, black, 0.004f);
  kit->block(&piece, {-0.03f, top + 0.012f, -0.03f}, {0.03f, y + 0.05f, -0.01f}, black, 0.004f);
  kit->block(&piece, {-half, y, -0.025f}, {half, y + high, 0.01f}, black, 0.006f);
  piece.add(
      panel({-half + 0.012f, y + 0.016f, 0.0105f}, {2 * half - 0.024f, 0, 0}, {0, high - 0.03f, 0}),
      kit->palette->screen());
  return piece;
}

}  // namespace lte::datagen::homes
