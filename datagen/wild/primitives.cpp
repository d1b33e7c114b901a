#include "datagen/wild/primitives.h"

#include <array>
#include <cmath>

#include "datagen/wild/builder.h"

namespace lte::datagen::wild {
namespace {

using homes::Piece;
using homes::translation;

/// Moves a mesh's vertices along its radius by three waves.
void crumple(float amount, Dice* dice, Mesh* mesh) {
  std::array<Vec3, 3> waves;
  std::array<float, 3> phases;
  const float size = length(homes::bounds_of(*mesh).extent());
  for (size_t i = 0; i < 3; ++i) {
    const float k = 2 * kPi * dice->draw(1, 4) / size;
    waves[i] = Vec3{dice->draw(-1, 1), dice->draw(-1, 1), dice->draw(-1, 1)} * k;
    phases[i] = dice->draw(0, 2 * kPi);
  }
  const Vec3 centre = homes::bounds_of(*mesh).center();
  homes::displace(mesh, [&](const Vec3& p) {
    float sum = 0;
    for (size_t i = 0; i < 3; ++i) sum += std::sin(dot(waves[i], p) + phases[i]);
    return (p - centre) * (amount * sum / 3);
  });
}

Mesh round_shape(float size, Dice* dice) {
  const float r = size * dice->draw(0.15f, 0.5f), h = size * dice->draw(0.2f, 1);
  const int turn = 4 * dice->count(3, 6);
  switch (dice->count(0, 4)) {
    case 0:
      return homes::lathe({{0, 0}, {r, 0}, {r, h}, {0, h}}, turn);
    case 1:
      return homes::lathe({{0, 0}, {r, 0}, {0, h}}, turn);
    case 2: {  // a torus that lies
      const float thin = r * dice->draw(0.1f, 0.4f);
      std::vector<Vec2> circle;
      for (int i = 0; i < 10; ++i) {
        const float a = 2 * kPi * static_cast<float>(i) / 10;
        circle.push_back({r - thin + thin * std::cos(a), thin + thin * std::sin(a)});
      }
      return homes::lathe(circle, turn, true);
    }
    case 3: {  // a vase
      std::vector<Vec2> profile{{0, 0}};
      for (int i = 0; i < 5; ++i)
        profile.push_back({r * dice->draw(0.3f, 1), h * static_cast<float>(i) / 4});
      profile.push_back({0, h});
      return homes::lathe(homes::smooth(profile, 2), turn);
    }
    default:
      return ball({0, r, 0}, r, turn);
  }
}

Mesh displaced_shape(float size, Dice* dice) {
  Mesh mesh;
  if (dice->chance(0.5f)) {
    mesh = ball({0, 0, 0}, size * dice->draw(0.2f, 0.5f), 4 * dice->count(4, 8));
  } else {
    const Vec3 half{size * dice->draw(0.15f, 0.5f), size * dice->draw(0.15f, 0.5f),
                    size * dice->draw(0.15f, 0.5f)};
    mesh = homes::rounded_box(-half, half, 0.1f * size, 1, 0.12f * size);
  }
  crumple(dice->draw(0.1f, 0.5f), dice, &mesh);
  const float low = homes::bounds_of(mesh).low.y;
  for (Vec3& p : mesh.positions) p.y -= low;
  return mesh;
}

/// A top on thin legs, or boards between thin uprights.
void add_frame(float size, Materials* materials, Dice* dice, Piece* piece) {
  const float w = size * dice->draw(0.4f, 1), d = size * dice->draw(0.3f, 0.8f),
              h = size * dice->draw(0.3f, 1.2f), thin = size * dice->draw(0.006f, 0.04f);
  const int legs = materials->thing(), boards = materials->thing();
  for (const float x : {-w / 2, w / 2 - thin})
    for (const float z : {-d / 2, d / 2 - thin})
      piece->add(block({x, 0, z}, {x + thin, h, z + thin}), legs);
  const int levels = dice->count(1, 4);
  for (int i = 0; i < levels; ++i) {
    const float y = h * (1 - static_cast<float>(i) / static_cast<float>(levels)) + (i ? 0 : 1e-3f);
    piece->add(block({-w / 2 - thin, y, -d / 2 - thin}, {w / 2 + thin, y + thin, d / 2 + thin}),
               boards);
    if (i == 0)
      piece->tops.push_back({{-w / 2, y + thin, -d / 2}, {w / 2, y + thin + 0.3f, d / 2}});
  }
}

/// Rods in a row, as of a fence or a radiator.
void add_rods(float size, Materials* materials, Dice* dice, Piece* piece) {
  const int rods = dice->count(5, 24), material = materials->thing();
  const float thin = size * dice->draw(0.004f, 0.02f), h = size * dice->draw(0.4f, 1.3f);
  for (int i = 0; i < rods; ++i) {
    const float x = size * (static_cast<float>(i) / static_cast<float>(rods) - 0.5f);
    piece->add(block({x, 0, -thin / 2}, {x + thin, h, thin / 2}), material);
  }
}

/// A cloth that hangs in waves, or a bent sheet.
Mesh cloth(float size, Dice* dice) {
  const float w = size * dice->draw(0.5f, 1), h = size * dice->draw(0.5f, 1.4f),
              depth = size * dice->draw(0.02f, 0.12f), waves = dice->draw(1, 6) * 2 * kPi;
  return homes::sheet(
      40, 4,
      [&](float u, float v) {
        return Vec3{(u - 0.5f) * w, v * h, depth * std::sin(waves * u) * (1 - 0.4f * v)};
      },
      0.002f * size);
}

/// Boxes on one another, each turned.
void add_pile(float size, Materials* materials, Dice* dice, Piece* piece) {
  float y = 0;
  for (int i = dice->count(2, 5); i > 0; --i) {
    const float w = size * dice->draw(0.2f, 0.5f), h = size * dice->draw(0.1f, 0.35f),
                d = size * dice->draw(0.2f, 0.5f);
    piece->add(block({-w / 2, 0, -d / 2}, {w / 2, h, d / 2}), materials->thing(),
               translation({0, y, 0}) * homes::rotation(1, dice->draw(0, 90)));
    y += h + 5e-4f * size;
  }
}

}  // namespace

Piece make_primitive(float size, Materials* materials, Dice* dice) {
  Piece piece;
  piece.name = "primitive";
  switch (dice->pick(std::array<float, 7>{0.25f, 0.2f, 0.15f, 0.15f, 0.08f, 0.07f, 0.1f})) {
    case 0: {
      const Vec3 half{size * dice->draw(0.1f, 0.5f), 0, size * dice->draw(0.1f, 0.5f)};
      piece.add(block(-half, half + Vec3{0, size * dice->log_draw(0.05f, 1.3f), 0}),
                materials->thing());
      break;
    }
    case 1:
      piece.add(round_shape(size, dice), materials->thing());
      break;
    case 2:
      piece.add(displaced_shape(size, dice), materials->thing());
      break;
    case 3:
      add_frame(size, materials, dice, &piece);
      break;
    case 4:
      add_rods(size, materials, dice, &piece);
      break;
    case 5:
      piece.add(cloth(size, dice), materials->thing());
      break;
    default:
      add_pile(size, materials, dice, &piece);
  }
  return piece;
}

}  // namespace lte::datagen::wild
