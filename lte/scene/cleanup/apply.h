// The changes that clean-up makes to a scene.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/scene/cleanup/topology.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// Moves the vertices of a mesh that share a place in its first instance onto the first of them.
void snap_vertices(const WorldTopology& topology, Scene* scene);

/// Removes the triangles that `removed` marks, one mark for each of WorldTopology::triangles; then
/// instances without triangles, and light groups without an emitter. Vertices stay.
/// @return  how many instanced triangles were removed
int64_t remove_triangles(const std::vector<bool>& removed, Scene* scene);

/// Removes meshes that no instance shows.
void drop_unused_meshes(Scene* scene);

}  // namespace lte::scene
