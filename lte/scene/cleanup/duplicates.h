// Meshes that are stored twice.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The first mesh that one is alike, and how far from it it lies in its own frame.
struct Twin {
  int mesh = kNone;  ///< kNone if there is none before it
  Vec3 offset;
};

/// Meshes are alike if material, triangles, texture coordinates and colors are equal and positions
/// differ by one translation, to within `tolerance` of the mesh's diagonal. One entry a mesh.
std::vector<Twin> find_twins(const Scene& scene, double tolerance);

int64_t count_twins(const std::vector<Twin>& twins);

/// Lets instances show the first of each kind in place of its twins, which go.
void merge_twins(const std::vector<Twin>& twins, Scene* scene);

}  // namespace lte::scene
