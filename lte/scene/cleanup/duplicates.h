// Meshes that are stored twice.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The first mesh that a mesh is a copy of, and the translation between the two.
struct DuplicateMesh {
  int mesh = kNone;  ///< kNone if no mesh before is alike
  Vec3 offset;
};

/// Meshes are alike if material, triangles, texture coordinates and colors are equal and positions
/// differ by one translation, to within `tolerance` of the mesh's diagonal. One entry a mesh.
std::vector<DuplicateMesh> find_duplicate_meshes(const Scene& scene, double tolerance);

int64_t count_duplicate_meshes(const std::vector<DuplicateMesh>& duplicates);

/// Lets instances show the first of alike meshes, and removes the others.
void merge_duplicate_meshes(const std::vector<DuplicateMesh>& duplicates, Scene* scene);

}  // namespace lte::scene
