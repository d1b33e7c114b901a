// Internal: charts of a scene's surfaces, by xatlas (Jonathan Young, MIT).
#pragma once

#include "lte/bake/atlas.h"

namespace lte::bake {

/// A picture with charts of all instances side by side: width, height, texels_per_metre, and
/// scene with uvs[1] in pixels.
/// @throws lte::Error as make_atlas()
Atlas make_charts(const scene::Scene& scene, const AtlasOptions& options);

/// The mesh with vertices `source` of it, in that order, and these triangles.
scene::Mesh split_mesh(const scene::Mesh& mesh, const std::vector<uint32_t>& source,
                       std::vector<std::array<uint32_t, 3>> triangles);

}  // namespace lte::bake
