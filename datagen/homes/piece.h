// A piece of furniture as it is modelled: triangles by material, the boxes of its parts, and the
// surfaces that things can stand on.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datagen/homes/mesh/mesh_parts.h"
#include "lte/base/math.h"

namespace lte::datagen::homes {

struct PointLight {
  Vec3 position;
  Rgb intensity;  ///< W sr^-1
};

/// Geometry in the piece's own frame, in metres: it stands on y = 0 unless it hangs, with its back
/// towards −z and its front towards +z.
struct Piece {
  std::string name;
  std::map<int, Mesh> meshes;  ///< by material; meshes of an emitter are one luminaire
  std::vector<Bounds> solids;  ///< one a part; those of two pieces must not overlap
  std::vector<Bounds> tops;    ///< free space above surfaces that carry things
  bool by_parts = false;       ///< others may stand between its parts, as under curtains
  std::vector<PointLight> point_lights;

  /// Adds a part. `solid` is false for a part that may touch other pieces, such as a leaf.
  void add(const Mesh& part, int material, const Affine& at = {}, bool solid = true);
  /// Adds all of another piece but its tops.
  void add(const Piece& other, const Affine& at);
  Bounds bounds() const;
};

/// A box turned about y, the form in which placed things are compared.
struct OrientedBox {
  Vec2 centre;              ///< x, z
  Vec2 half;                ///< along its own axes
  Vec2 axis{1, 0};          ///< of its own x, in x and z
  float low = 0, high = 0;  ///< y
};

/// @param at  a rotation about y and a translation
OrientedBox oriented_box(const Bounds& local, const Affine& at);

/// Whether at least `gap` metres lie between the two along a separating axis. A negative gap allows
/// that much overlap.
bool apart(const OrientedBox& a, const OrientedBox& b, float gap);

/// The axis-aligned bounds of a turned box.
Bounds bounds_of(const OrientedBox& box);

}  // namespace lte::datagen::homes
