#include "datagen/boxes/furniture.h"

#include <algorithm>
#include <cmath>

namespace lte::datagen::boxes {
namespace {

/// One piece in the making, with the shorthands that the functions below share.
struct Maker {
  Assembly piece;
  MaterialFactory* materials;
  Rng* rng;

  float draw(float low, float high) { return rng->uniform(low, high); }
  int count(int low, int high) {
    return low + static_cast<int>(rng->below(static_cast<uint64_t>(high - low + 1)));
  }
  bool chance(float probability) { return rng->uniform() < probability; }

  void box(const Vec3& low, const Vec3& high, int material, unsigned faces = kNoBottom) {
    piece.parts.push_back({low, high, material, faces, 0, false});
  }
  void cylinder(float x, float z, float radius, float y0, float y1, int material,
                unsigned faces = kNoBottom, int segments = 16) {
    piece.parts.push_back({{x - radius, y0, z - radius},
                           {x + radius, y1, z + radius},
                           material,
                           faces,
                           segments,
                           false});
  }
};

/// Puts up to three small things on the horizontal rectangle ±half_w × ±half_d at height y.
void put_things_on(Maker* m, float half_w, float half_d, float y, float height_limit) {
  std::vector<Bounds> taken;
  const int things = m->count(0, 3);
  for (int i = 0; i < things; ++i) {
    const float w = m->draw(0.05f, 0.15f), d = m->draw(0.05f, 0.15f);
    const float h = std::min(m->draw(0.05f, 0.3f), height_limit);
    if (half_w < w + 0.02f || half_d < d + 0.02f || h < 0.04f) continue;
    const float x = m->draw(-half_w + w + 0.01f, half_w - w - 0.01f);
    const float z = m->draw(-half_d + d + 0.01f, half_d - d - 0.01f);
    const bool free = std::none_of(taken.begin(), taken.end(), [&](const Bounds& b) {
      return x - w < b.high.x + 0.01f && x + w > b.low.x - 0.01f && z - d < b.high.z + 0.01f &&
             z + d > b.low.z - 0.01f;
    });
    if (!free) continue;
    taken.push_back({{x - w, y, z - d}, {x + w, y + h, z + d}});
    if (m->chance(0.4f)) {
      m->cylinder(x, z, std::min(w, d), y, y + h, m->materials->paint());
    } else {
      m->box({x - w, y, z - d}, {x + w, y + h, z + d}, m->materials->paint());
    }
  }
}

/// A slab on four legs.
void slab_on_legs(Maker* m, float x, float z, float half_w, float half_d, float top,
                  float thickness, int slab, int legs) {
  const float leg = m->draw(0.02f, 0.04f), inset = leg + 0.02f;
  const bool round = m->chance(0.4f);
  const unsigned mantle = kSides;  // both ends are covered: by the floor and by the slab
  for (const float sx : {-1.0f, 1.0f}) {
    for (const float sz : {-1.0f, 1.0f}) {
      const float cx = x + sx * (half_w - inset), cz = z + sz * (half_d - inset);
      if (round) {
        m->cylinder(cx, cz, leg, 0, top - thickness, legs, mantle, 10);
      } else {
        m->box({cx - leg, 0, cz - leg}, {cx + leg, top - thickness, cz + leg}, legs, mantle);
      }
    }
  }
  m->box({x - half_w, top - thickness, z - half_d}, {x + half_w, top, z + half_d}, slab, kAllFaces);
}

/// @param back  +1 or −1: the side of the seat, along z, on which the back stands
void chair(Maker* m, float x, float z, float back, int seat, int legs) {
  const float half = 0.21f, height = 0.45f;
  slab_on_legs(m, x, z, half, half, height, 0.03f, seat, legs);
  const float z0 = back > 0 ? z + half - 0.03f : z - half;
  m->box({x - half, height, z0}, {x + half, m->draw(0.8f, 0.95f), z0 + 0.03f}, seat);
}

void table(Maker* m) {
  const float half_w = m->draw(0.4f, 0.9f), half_d = m->draw(0.3f, 0.5f),
              top = m->draw(0.7f, 0.76f);
  const int wood = m->materials->wood();
  const int legs = m->chance(0.5f) ? wood : m->materials->paint();
  slab_on_legs(m, 0, 0, half_w, half_d, top, m->draw(0.025f, 0.05f), wood, legs);
  put_things_on(m, half_w, half_d, top, 0.3f);
  const int seat = m->chance(0.5f) ? m->materials->fabric() : wood;
  const float apart = m->draw(0.02f, 0.25f);
  const int a_side = half_w > 0.55f ? 2 : 1;
  for (const float side : {-1.0f, 1.0f}) {
    for (int i = 0; i < a_side; ++i) {
      if (!m->chance(0.7f)) continue;
      const float x = a_side == 1 ? 0 : (i == 0 ? -0.5f : 0.5f) * half_w;
      chair(m, x, side * (half_d + 0.21f + apart), side, seat, legs);
    }
  }
}

void coffee_table(Maker* m) {
  const float half_w = m->draw(0.3f, 0.6f), half_d = m->draw(0.25f, 0.4f),
              top = m->draw(0.35f, 0.5f);
  const int wood = m->materials->wood();
  slab_on_legs(m, 0, 0, half_w, half_d, top, m->draw(0.02f, 0.06f), wood, m->materials->paint());
  put_things_on(m, half_w, half_d, top, 0.25f);
}

void desk(Maker* m) {
  const float half_w = m->draw(0.5f, 0.8f), half_d = m->draw(0.3f, 0.4f),
              top = m->draw(0.7f, 0.76f);
  const int wood = m->materials->wood(), dark = m->materials->dark();
  slab_on_legs(m, 0, 0, half_w, half_d, top, 0.03f, wood, dark);
  const float half = m->draw(0.2f, 0.32f), high = m->draw(0.3f, 0.4f), z = -half_d * 0.5f;
  m->box({-0.12f, top, z - 0.08f}, {0.12f, top + 0.02f, z + 0.08f}, dark);
  m->box({-0.02f, top + 0.02f, z - 0.02f}, {0.02f, top + 0.1f, z + 0.02f}, dark, kSides);
  m->box({-half, top + 0.1f, z - 0.025f}, {half, top + 0.1f + high, z + 0.025f}, dark, kAllFaces);
}

void cabinet(Maker* m, float room_height) {
  const float half_w = m->draw(0.3f, 0.8f), half_d = m->draw(0.17f, 0.3f);
  const float high = std::min(m->draw(0.6f, 2.2f), room_height - 0.12f);
  const int body = m->chance(0.5f) ? m->materials->wood() : m->materials->paint();
  const int front = m->chance(0.5f) ? body : m->materials->paint();
  m->box({-half_w, 0, -half_d}, {half_w, high, half_d}, body);
  const int doors = m->count(1, 3);
  const float width = 2 * half_w / static_cast<float>(doors);
  for (int i = 0; i < doors; ++i) {
    const float x = -half_w + width * static_cast<float>(i);
    m->box({x + 0.01f, 0.05f, half_d}, {x + width - 0.01f, high - 0.02f, half_d + 0.018f}, front,
           kAllFaces & ~kNegZ);
  }
  if (high < 1.3f) put_things_on(m, half_w, half_d, high, 0.3f);
}

void shelf(Maker* m, float room_height) {
  const float half_w = m->draw(0.3f, 0.7f), half_d = m->draw(0.14f, 0.2f), thick = 0.025f;
  const float high = std::min(m->draw(0.9f, 2.1f), room_height - 0.12f);
  const int wood = m->chance(0.6f) ? m->materials->wood() : m->materials->trim();
  const float back = -half_d + 0.01f, inner = half_w - thick;
  m->box({-half_w, 0, -half_d}, {half_w, high, back}, wood);
  m->box({-half_w, 0, back}, {-inner, high, half_d}, wood, kNoBottom & ~kNegZ);
  m->box({inner, 0, back}, {half_w, high, half_d}, wood, kNoBottom & ~kNegZ);
  const int rows = std::max(2, static_cast<int>(high / m->draw(0.3f, 0.45f)));
  const float pitch = (high - thick) / static_cast<float>(rows);
  const unsigned board = kNegY | kPosY | kPosZ;
  for (int row = 0; row <= rows; ++row) {
    const float y = pitch * static_cast<float>(row);
    m->box({-inner, y, back}, {inner, y + thick, half_d}, wood, row == 0 ? board & ~kNegY : board);
    if (row == rows) break;
    float x = -inner + 0.01f;  // blocks of books, none of which touches another
    while (m->chance(0.8f)) {
      const float w = m->draw(0.04f, 0.22f);
      const float h = m->draw(0.4f, 0.9f) * (pitch - thick), d = m->draw(0.1f, 2 * half_d - 0.03f);
      if (x + w > inner - 0.01f) break;
      m->box({x, y + thick, back + 0.005f}, {x + w, y + thick + h, back + 0.005f + d},
             m->materials->paint());
      x += w + m->draw(0.004f, 0.12f);
    }
  }
}

void sofa(Maker* m) {
  const float half_w = m->draw(0.5f, 1.1f), half_d = m->draw(0.4f, 0.48f),
              arm = m->draw(0.12f, 0.2f);
  const float seat = m->draw(0.3f, 0.36f), back = -half_d + m->draw(0.16f, 0.22f);
  const int fabric = m->materials->fabric();
  m->box({-half_w, 0, -half_d}, {half_w, m->draw(0.75f, 0.9f), back}, fabric);
  const float arm_height = m->draw(0.52f, 0.65f);
  m->box({-half_w, 0, back}, {-half_w + arm, arm_height, half_d}, fabric, kNoBottom & ~kNegZ);
  m->box({half_w - arm, 0, back}, {half_w, arm_height, half_d}, fabric, kNoBottom & ~kNegZ);
  const float inner = half_w - arm;
  m->box({-inner, 0, back}, {inner, seat, half_d}, fabric, kPosY | kPosZ);
  const int cushions = std::max(1, static_cast<int>(2 * inner / 0.65f));
  const float width = 2 * inner / static_cast<float>(cushions);
  const int cover = m->chance(0.5f) ? fabric : m->materials->fabric();
  for (int i = 0; i < cushions; ++i) {
    const float x = -inner + width * static_cast<float>(i);
    m->box({x + 0.008f, seat, back + 0.01f}, {x + width - 0.008f, seat + 0.12f, half_d - 0.01f},
           cover);
  }
}

void bed(Maker* m) {
  const float half_w = m->draw(0.45f, 0.9f), half_d = 1.0f, frame = m->draw(0.2f, 0.32f);
  const int wood = m->materials->wood(), cover = m->materials->fabric();
  const int pillow = m->materials->trim();
  const float head = -half_d + 0.05f, top = frame + m->draw(0.14f, 0.22f);
  m->box({-half_w, 0, -half_d}, {half_w, m->draw(0.7f, 1.1f), head}, wood);
  m->box({-half_w, 0, head}, {half_w, frame, half_d}, wood, kNoBottom & ~kNegZ);
  m->box({-half_w + 0.02f, frame, head + 0.01f}, {half_w - 0.02f, top, half_d - 0.02f}, cover);
  const int pillows = half_w > 0.65f ? 2 : 1;
  for (int i = 0; i < pillows; ++i) {
    const float x = pillows == 1 ? 0 : (i == 0 ? -0.5f : 0.5f) * half_w;
    m->box({x - 0.28f, top, head + 0.06f}, {x + 0.28f, top + 0.1f, head + 0.42f}, pillow);
  }
}

void lamp(Maker* m, float room_height) {
  const float high = std::min(m->draw(1.3f, 1.8f), room_height - 0.3f), shade = m->draw(0.2f, 0.3f);
  const int dark = m->materials->dark();
  m->cylinder(0, 0, m->draw(0.12f, 0.16f), 0, 0.02f, dark);
  m->cylinder(0, 0, m->draw(0.012f, 0.02f), 0.02f, high - shade, dark, kSides, 8);
  m->cylinder(0, 0, m->draw(0.15f, 0.22f), high - shade, high, m->materials->paint(), kAllFaces,
              20);
}

void plant(Maker* m, float room_height) {
  const float pot = m->draw(0.12f, 0.22f), pot_height = m->draw(0.2f, 0.4f);
  m->cylinder(0, 0, pot, 0, pot_height, m->materials->paint());
  const int wood = m->materials->wood(), leaves = m->materials->fabric();
  const int tiers = m->count(2, 4);
  float y = pot_height, radius = m->draw(0.2f, 0.4f);
  for (int i = 0; i < tiers; ++i) {
    const float stem = m->draw(0.08f, 0.2f), tier = m->draw(0.05f, 0.16f);
    if (y + stem + tier > room_height - 0.1f) break;
    m->cylinder(0, 0, 0.02f, y, y + stem, wood, kSides, 8);
    m->cylinder(0, 0, radius, y + stem, y + stem + tier, leaves, kAllFaces, 9);
    y += stem + tier;
    radius *= 0.8f;
  }
}

void cartons(Maker* m) {
  float half_w = m->draw(0.15f, 0.35f), half_d = m->draw(0.15f, 0.3f), y = 0;
  const int boxes = m->count(1, 3);
  for (int i = 0; i < boxes; ++i) {
    const float high = m->draw(0.15f, 0.4f);
    m->box({-half_w, y, -half_d}, {half_w, y + high, half_d}, m->materials->paint());
    y += high;
    half_w *= m->draw(0.7f, 0.95f);
    half_d *= m->draw(0.7f, 0.95f);
  }
}

void single_box(Maker* m, float half_w, float half_d, float high, int material, unsigned faces) {
  m->box({-half_w, 0, -half_d}, {half_w, high, half_d}, material, faces);
}

}  // namespace

bool stands_at_wall(PieceKind kind) {
  switch (kind) {
    case PieceKind::Desk:
    case PieceKind::Cabinet:
    case PieceKind::Shelf:
    case PieceKind::Sofa:
    case PieceKind::Bed:
      return true;
    default:
      return false;
  }
}

Assembly make_piece(PieceKind kind, float room_height, MaterialFactory* materials, Rng* rng) {
  Maker m{{}, materials, rng};
  static constexpr const char* kNames[kPieceKinds] = {
      "table", "coffee table", "desk",  "cabinet", "shelf", "sofa",  "bed",
      "lamp",  "plant",        "stool", "cartons", "rug",   "pillar"};
  m.piece.name = kNames[static_cast<int>(kind)];
  switch (kind) {
    case PieceKind::Table:
      table(&m);
      break;
    case PieceKind::CoffeeTable:
      coffee_table(&m);
      break;
    case PieceKind::Desk:
      desk(&m);
      break;
    case PieceKind::Cabinet:
      cabinet(&m, room_height);
      break;
    case PieceKind::Shelf:
      shelf(&m, room_height);
      break;
    case PieceKind::Sofa:
      sofa(&m);
      break;
    case PieceKind::Bed:
      bed(&m);
      break;
    case PieceKind::Lamp:
      lamp(&m, room_height);
      break;
    case PieceKind::Plant:
      plant(&m, room_height);
      break;
    case PieceKind::Stool: {
      const float radius = m.draw(0.15f, 0.22f);
      m.cylinder(0, 0, radius, 0, m.draw(0.4f, 0.5f), materials->fabric(), kNoBottom, 20);
      break;
    }
    case PieceKind::Cartons:
      cartons(&m);
      break;
    case PieceKind::Rug: {
      const float half_w = m.draw(0.4f, 1.1f);
      single_box(&m, half_w, m.draw(0.3f, 0.8f), 0.01f, materials->fabric(), kNoBottom);
      break;
    }
    case PieceKind::Pillar: {
      const float half = m.draw(0.12f, 0.25f);
      single_box(&m, half, half, room_height, materials->wall(), kSides);
      break;
    }
  }
  return m.piece;
}

}  // namespace lte::datagen::boxes
