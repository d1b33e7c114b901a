// Puts meshes into a wild scene and remembers what stands where.
#pragma once

#include <string>
#include <vector>

#include "datagen/homes/piece.h"
#include "datagen/wild/materials.h"
#include "datagen/wild/plan.h"

namespace lte::datagen::wild {

using homes::Mesh;
using homes::OrientedBox;

/// A luminaire whose brightness is not set yet: what has its radiance, and for how much power.
struct Lamp {
  LampKind kind = LampKind::Point;
  std::vector<int> materials;  ///< emitters of unit luminance times a color
  std::vector<size_t> lights;  ///< into Scene::lights, of unit intensity times a color
  float power = 0;             ///< W at unit luminance, of surfaces and lights
};

class Builder {
 public:
  Builder(scene::Scene* out, Plan* cells, Materials* surfaces)
      : scene(out), plan(cells), materials(surfaces), taken(cells->cells.size()) {}

  /// Adds a mesh; one that emits joins the light group.
  void add(Mesh&& mesh, int material, const Affine& at, const std::string& name);
  /// Adds a piece of furniture, without its point lights.
  void add(homes::Piece&& piece, const Affine& at);
  /// Makes `group` that of the next lamp: kMaxGroups at most, which further lamps share in turn.
  void next_group();
  /// Takes back a group that no lamp came to use.
  void drop_group();

  /// Whether a box of a cell meets nothing that stands there.
  bool is_free(int cell, const OrientedBox& box, float gap) const;
  /// A box within the walls and under the ceiling of a cell.
  bool fits(int cell, const OrientedBox& box, float margin) const;

  scene::Scene* scene;
  Plan* plan;
  Materials* materials;
  std::vector<std::vector<OrientedBox>> taken;  ///< by cell
  std::vector<Lamp> lamps;
  int group = scene::kNone;  ///< of what emits and is added next

 private:
  int shared_ = 0;
  bool new_group_ = false;
};

/// x along an edge from its first corner, y up from the floor, z inwards.
Affine edge_frame(const Cell& cell, size_t edge);
/// Turned by `angle` radians about y, standing at a point.
Affine standing(const Vec2& at, float y, float angle);
/// The outline of a box in plan.
Polygon outline_of(const OrientedBox& box);
/// A closed box. UVs in metres.
Mesh block(const Vec3& low, const Vec3& high);
/// A rectangle whose front faces right × up, with UVs in metres.
Mesh sheet_of(const Vec3& corner, const Vec3& right, const Vec3& up);
Mesh ball(const Vec3& centre, float radius, int turn);

}  // namespace lte::datagen::wild
