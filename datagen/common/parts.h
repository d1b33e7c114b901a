// Boxes and cylinders, the parts that rooms and furniture are made of, and their triangles.
#pragma once

#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

/// Faces of a part, as bits. A cylinder has its mantle, which all four sides stand for, and two
/// ends.
inline constexpr unsigned kNegX = 1, kPosX = 2, kNegY = 4, kPosY = 8, kNegZ = 16, kPosZ = 32;
inline constexpr unsigned kAllFaces = 63;
/// For a part that stands on something else: its bottom would coincide with the face below.
inline constexpr unsigned kNoBottom = kAllFaces & ~kNegY;
inline constexpr unsigned kSides = kNegX | kPosX | kNegZ | kPosZ;

/// An axis-aligned box, or a cylinder about Y inscribed in it.
struct Part {
  Vec3 low, high;
  int material = 0;
  unsigned faces = kAllFaces;  ///< those that have triangles
  int segments = 0;            ///< of a cylinder; 0 for a box
  bool inward = false;         ///< normals point to the inside, as for the walls of a room
};

/// Parts that belong together, in their own frame: standing on y = 0 about the origin, front
/// towards +z.
struct Assembly {
  std::string name;
  std::vector<Part> parts;

  Bounds bounds() const;
};

/// Adds the meshes of `parts`, one a material, and returns their indices. UVs are in metres from
/// each face's corner.
std::vector<int> add_meshes(scene::Scene* scene, const std::string& name,
                            const std::vector<Part>& parts);

/// Rotation by `degrees` about Y (+z turns towards +x), exact for quarter turns, then translation.
Affine placement(double degrees, const Vec3& translation);

/// World bounds of a placed box.
Bounds transformed(const Bounds& bounds, const Affine& to_world);

}  // namespace lte::datagen
