// What every maker of furniture works with: materials, random numbers, the fineness of curves, and
// the few shapes that most pieces share.
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
  float lit_share = 0.7f;  ///< of lamps that are on

  float draw(float low, float high) { return rng.uniform(low, high); }
  int count(int low, int high) {
    return low + static_cast<int>(rng.below(static_cast<uint64_t>(int64_t{high} - low + 1)));
  }
  bool chance(float probability) { return rng.uniform() < probability; }

  /// Adds a rounded box whose texture starts at a place of its own.
  void block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius = 0.004f,
             const Affine& at = {});
  /// Adds an upholstered box: generously rounded, bulging and a little uneven.
  void soft_block(Piece* piece, const Vec3& low, const Vec3& high, int material, float radius,
                  float bulge_m, const Affine& at = {});
  /// Adds a cushion of the given size whose middle is at the origin of `at`.
  void pillow(Piece* piece, const Vec3& size, int material, const Affine& at);
  /// Adds a round body about the vertical axis through `at`, with the profile's heights above it.
  void turned(Piece* piece, const std::vector<Vec2>& profile, int material, const Vec3& at = {},
              bool ring = false, int smooth_steps = 4);
  void bar(Piece* piece, const std::vector<Vec3>& path, float radius, int material);

  /// Shapes of legs.
  enum class Legs { Square, Tapered, Bars };
  /// Adds four legs at the corners of the box from `low` to `high`, as long as it is high.
  void legs(Piece* piece, const Vec3& low, const Vec3& high, float thickness, Legs kind,
            int material);

  /// Adds a front of doors and drawers on the +z side of a carcass, with knobs or bars as handles.
  /// @param low, high  rectangle at z = low.z; fronts stand out by their thickness
  void fronts(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers,
              int material, int handle);
  /// Adds carcass, plinth and fronts, for wardrobes, dressers and kitchen units.
  void cabinet(Piece* piece, const Vec3& low, const Vec3& high, int columns, int drawers, int body,
               int front, int handle);
  /// Adds upright books between x0 and x1 on a board at y, with their spines towards +z at z1.
  void book_row(Piece* piece, float x0, float x1, float y, float clear, float z0, float z1);
};

}  // namespace lte::datagen::homes
