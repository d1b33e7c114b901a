// Potted plants: pot, soil, stems, leaves.
#include <algorithm>
#include <cmath>

#include "datagen/homes/furniture/furniture.h"

namespace lte::datagen::homes {
namespace {

/// A leaf that starts at the origin, grows along +z and droops under its weight.
Mesh leaf(const Detail& detail, float length, float width, float rise, float droop) {
  const auto at = [&](float u, float v) {
    const float s = 2 * u - 1;
    const float outline = std::max(0.04f, std::sin(kPi * std::pow(std::min(v, 0.985f), 0.8f)));
    const float fold = 0.25f * width * s * s * outline;
    return Vec3{s * 0.5f * width * outline, rise * length * v - droop * length * v * v + fold,
                length * v * (1 - 0.2f * v)};
  };
  const int across = std::max(2, static_cast<int>(std::lround(2 * detail.level)) * 2);
  return sheet(across, std::max(4, static_cast<int>(std::lround(7 * detail.level))), at, 0.0016f);
}

/// Pot with soil; returns the height of the soil.
float add_pot(Kit* kit, Piece* plant, float radius, float height) {
  const float r = radius, h = height, soil = 0.86f * h;
  const float foot = kit->draw(0.65f, 0.95f) * r;
  kit->turned(plant,
              {{0, 0},
               {foot, 0},
               {0.5f * (foot + r), 0.5f * h},
               {r, 0.97f * h},
               {r, h},
               {0.9f * r, h},
               {0.88f * r, 0.9f * h},
               {0.86f * r, 0.78f * h},
               {0, 0.76f * h}},
              kit->palette->pot(), {}, false, 2);
  kit->turned(plant, {{0, 0.77f * h}, {0.86f * r, 0.79f * h}, {0.85f * r, 0.84f * h}, {0, soil}},
              kit->palette->soil(), {}, false, 1);
  return soil;
}

Affine heading(const Vec3& at, float azimuth) { return translation(at) * rotation(1, azimuth); }

}  // namespace

Piece make_plant(Kit* kit, float height) {
  Piece plant;
  plant.name = "plant";
  const float r = std::clamp(0.16f * height, 0.05f, 0.2f), pot = 1.6f * r;
  const float soil = add_pot(kit, &plant, r, pot), grown = height - soil;
  const int green = kit->palette->leaf();
  const auto add_leaf = [&](const Mesh& mesh, const Affine& at) {
    plant.add(mesh, green, at, false);
  };
  const int style = kit->count(0, 2);
  if (style == 0) {  // blades from the ground
    const int blades = kit->count(9, 18);
    for (int i = 0; i < blades; ++i) {
      const float azimuth = 137.5f * static_cast<float>(i), l = grown * kit->draw(0.7f, 1) / 1.05f;
      const float reach = 0.35f * r * static_cast<float>(i % 4) / 3;
      const float a = azimuth * kPi / 180;
      const Mesh blade =
          leaf(kit->detail, l, 0.09f * std::sqrt(height), 0, kit->draw(0.05f, 0.15f));
      add_leaf(blade, heading({reach * std::sin(a), soil - 0.01f, reach * std::cos(a)}, azimuth) *
                          rotation(0, -kit->draw(68, 82)));
    }
  } else if (style == 1) {  // a small tree
    const int wood = kit->palette->bark(), twigs = kit->count(6, 9);
    const Vec3 crown{kit->draw(-0.04f, 0.04f) * height, soil + 0.92f * grown,
                     kit->draw(-0.04f, 0.04f) * height};
    kit->bar(
        &plant,
        smooth(
            std::vector<Vec3>{{0, soil - 0.02f, 0}, {crown.z, soil + 0.4f * grown, crown.x}, crown},
            6),
        0.011f * std::sqrt(height), wood);
    for (int i = 0; i < twigs; ++i) {
      const float t = 0.4f + 0.6f * static_cast<float>(i) / static_cast<float>(twigs),
                  azimuth = 137.5f * static_cast<float>(i);
      const float reach = 0.24f * height * (1.15f - 0.6f * t), a = azimuth * kPi / 180;
      const Vec3 from{crown.x * t, soil + 0.92f * grown * t, crown.z * t};
      const Vec3 to = from + Vec3{reach * std::sin(a), 0.06f * height, reach * std::cos(a)};
      plant.add(tube(smooth(std::vector<Vec3>{from, (from + to) * 0.5f + Vec3{0, 0.03f, 0}, to}, 3),
                     0.004f * std::sqrt(height), kit->detail.turn(0.004f)),
                wood, {}, false);
      const int leaves = 7;
      for (int k = 0; k < leaves; ++k) {
        const float s = 0.35f + 0.65f * static_cast<float>(k) / (leaves - 1);
        const Mesh l = leaf(kit->detail, kit->draw(0.08f, 0.13f) * height, 0.055f * height, 0.35f,
                            kit->draw(0.2f, 0.6f));
        add_leaf(l, heading(from + (to - from) * s,
                            azimuth + (k % 2 ? 70.0f : -70.0f) * (k == leaves - 1 ? 0.0f : 1.0f) +
                                kit->draw(-15, 15)));
      }
    }
  } else {  // stalks that arch, a big leaf on each
    const int stalks = kit->count(9, 15);
    for (int i = 0; i < stalks; ++i) {
      const float azimuth = 137.5f * static_cast<float>(i), a = azimuth * kPi / 180;
      const float up = grown * kit->draw(0.45f, 0.9f), out = 0.24f * height * kit->draw(0.5f, 1.1f);
      const Vec3 tip{out * std::sin(a), soil + up, out * std::cos(a)};
      plant.add(tube(smooth(std::vector<Vec3>{{0, soil - 0.01f, 0},
                                              {0.25f * tip.x, soil + 0.6f * up, 0.25f * tip.z},
                                              tip},
                            4),
                     0.005f * std::sqrt(height), kit->detail.turn(0.004f)),
                green, {}, false);
      const float l = kit->draw(0.2f, 0.28f) * height;
      add_leaf(leaf(kit->detail, l, 0.62f * l, 0.15f, kit->draw(0.5f, 0.9f)),
               heading(tip, azimuth + kit->draw(-20, 20)));
    }
  }
  return plant;
}

}  // namespace lte::datagen::homes
