// Puts pieces into the scene of a home and records in its plan where they are.
#pragma once

#include <string>
#include <vector>

#include "datagen/homes/home.h"
#include "datagen/homes/kit.h"

namespace lte::datagen::homes {

/// A piece whose triangles are in the scene, ready to be placed, if wanted more than once.
struct Asset {
  std::string name;
  Bounds bounds;
  std::vector<Bounds> solids, tops;
  bool by_parts = false;
  std::vector<PointLight> point_lights;
  std::vector<int> meshes;
};

class Stage {
 public:
  explicit Stage(Home* home) : home_(home) {}

  HomePlan& plan() { return home_->plan; }
  const HomePlan& plan() const { return home_->plan; }
  scene::Scene& scene() { return home_->scene; }

  /// Moves the piece's triangles into the scene.
  Asset load(Piece&& piece);
  /// An asset without triangles, to try places with.
  static Asset outline(const Piece& piece);

  /// Instances the asset. Each emissive mesh and point light becomes a light group.
  /// @return  its index in the plan
  int place(const Asset& asset, int room, const Affine& to_world, int parent = -1);
  /// Adds the triangles of a piece that was placed as an outline.
  void fill(int placed, Piece&& piece);
  /// Like place(), for parts of the building, which are no furniture.
  void build(Piece&& piece);
  /// Adds a light group and returns its index.
  int add_group(const std::string& name);

 private:
  void instance(const Asset& asset, const std::string& name, const Affine& to_world);

  Home* home_;
};

PlacedPiece placed(const Asset& asset, int room, const Affine& to_world, int parent);

}  // namespace lte::datagen::homes
