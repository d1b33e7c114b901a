// Where each triangle of a scene lies in the picture that a light map is.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/bake/lightmap.h"

namespace lte::bake {

/// The widest and highest picture that a bake writes, as engines take them.
inline constexpr int kMaxAtlas = 16384;

struct AtlasOptions {
  double texels_per_metre = 32;
  int size = 0;  ///< edge of the square picture; 0: as large as `texels_per_metre` asks for
  bool keep_uvs = false;  ///< only the scene's own TEXCOORD_1 will do
};

struct Atlas {
  int width = 0, height = 0;
  double texels_per_metre = 0;  ///< as it came out: root of texels over area
  bool kept_uvs = false;        ///< the scene's own TEXCOORD_1, else new charts
  scene::Scene scene;           ///< as Lightmap::scene
  std::vector<Placement> placements;
  /// [instances][triangles]: number of its chart, kNone for a triangle without area or place.
  std::vector<std::vector<int32_t>> chart;
  int32_t charts = 0;
  int64_t lost_triangles = 0;  ///< without a chart
};

/// Keeps TEXCOORD_1 where all instances have it, inside [0, 1], and no two triangles of the scene
/// overlap there; else makes charts and packs them (xatlas).
/// @throws lte::Error where the picture would be wider or higher than kMaxAtlas, where no triangle
///         has an area, and under keep_uvs where TEXCOORD_1 will not do, saying why.
Atlas make_atlas(const scene::Scene& scene, const AtlasOptions& options);

/// The same by new charts, whatever TEXCOORD_1 is.
Atlas make_atlas_of_charts(const scene::Scene& scene, const AtlasOptions& options);

/// Charts, names and rectangles of an atlas whose scene.meshes have uvs[1] in [0, 1].
void finish_atlas(const scene::Scene& source, Atlas* atlas);

}  // namespace lte::bake
