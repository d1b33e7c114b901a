// What every maker of furniture is handed: materials, random numbers and fineness, and the few
// shapes that most pieces share.
#pragma once

#include <vector>

#include "datagen/homes/mesh/mesh_parts.h"
#include "datagen/homes/palette.h"
#include "datagen/homes/piece.h"
#include "lte/base/random.h"

namespace lte::datagen::homes {

struct Kit {
  Palette* palette;
  Rng rng;
  Detail detail;
  /// Luminance, W sr^-1 m^-2, of a ceiling light of this home; lamps follow it.
  float radiance = 10;
  float lit_share = 0.7f;  ///< of lamps

  float draw(float low, float high) { return rng.uniform(low, high); }
  int count(int low, int high) {
    return low + static_cast<int>(rng.below(static_cast<uint64_t>(high - low + 1)));
  }
  bool chance(float probability) { return rng.uniform() < probability; }

  /// A rounded box whose texture starts at a place of its own.
  void block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius = 0.004f,
             const Affine& at = {});
  /// An upholstered box: generously rounded, bulging and a little uneven.
  void soft_block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius,
                  float bulge_m, const Affine& at = {});
  /// A cushion of the given size, its middle at `at`'s origin.
  void pillow(Piece* piece, const Vec3& size, int material, const Affine& at);
  /// Round body about the y axis through (x, z); the profile's heights start at y.
  void turned(Piece* piece, const std::vector<Vec2>& profile, int material, const Vec3& at = {},
              bool ring = false, int smooth_steps = 4);
  void bar(Piece* piece, const std::vector<Vec3>& path, float radius, int material);

  /// Four legs at the corners of low to high (y is their length); straight, tapered or splayed.
  enum class Legs { Square, Tapered, Bars };
  void legs(Piece* piece, const Vec3& low, const Vec3& high, float thickness, Legs kind,
            int material);

  /// A front of doors and drawers on the +z side of a carcass, with knobs or bars as handles.
  /// @param low, high  rectangle at z = low.z; fronts stand out by their thickness
  void fronts(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers,
              int material, int handle);
  /// Carcass, plinth and fronts: wardrobes, dressers, kitchen units.
  void cabinet(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers, int body,
               int front, int handle);
  /// Upright books between x0 and x1 on a board at y, spines towards +z at z1.
  void book_row(Piece* piece, float x0, float x1, float y, float clear, float z0, float z1);
};

}  // namespace lte::datagen::homes
