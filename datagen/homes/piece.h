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

/// In its own frame: on y = 0 unless it hangs, back towards −z, front towards +z, metres.
struct Piece {
  std::string name;
  std::map<int, Mesh> meshes;  ///< by material; meshes of an emitter are one luminaire
  std::vector<Bounds> solids;  ///< one a part: what must not interpenetrate
  std::vector<Bounds> tops;    ///< free room above surfaces that carry things
  bool by_parts = false;       ///< others may stand between its parts, as under curtains
  std::vector<PointLight> point_lights;

  /// Adds a part. `solid` is false for what may touch other pieces, such as leaves.
  void add(const Mesh& part, int material, const Affine& at = {}, bool solid = true);
  /// Adds all of another piece but its tops.
  void add(const Piece& other, const Affine& at);
  Bounds bounds() const;
};

/// A box turned about y: how placed things are compared.
struct OrientedBox {
  Vec2 centre;              ///< x, z
  Vec2 half;                ///< along its own axes
  Vec2 axis{1, 0};          ///< of its own x, in x and z
  float low = 0, high = 0;  ///< y
};

/// @param at  a rotation about y and a translation
OrientedBox oriented_box(const Bounds& local, const Affine& at);

/// At least `gap` metres lie between the two along a separating axis (negative: so much overlap is
/// let pass).
bool apart(const OrientedBox& a, const OrientedBox& b, float gap);

/// World bounds.
Bounds bounds_of(const OrientedBox& box);

}  // namespace lte::datagen::homes
