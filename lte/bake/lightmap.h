// A light map in memory: what lte_bake computes and every writer of files reads.
//
// Pixel (x, y) of the atlas has its center at uv ((x + 0.5) / width, (y + 0.5) / height): v points
// down and row 0 is the top, as glTF has it. Irradiance is E in W/m², linear Rec.709; a diffuse
// surface of albedo a sends out a E / π.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::bake {

/// What stands in a pixel of the atlas. The values are those of Lightmap::mask.
enum class Texel : uint8_t {
  Outside = 0,  ///< of every chart; 0
  Lit = 1,      ///< by its own samples
  Filled = 2,   ///< from its neighbours in the chart, or beyond a chart's border by dilation
  Dark = 3      ///< of a chart, where no light reaches; 0
};

/// Light of one kind. Layers add up to all light that was baked.
struct Layer {
  std::string name;               ///< of the light group; "light" where all are in one
  std::vector<float> irradiance;  ///< [height, width, 3] E, W/m²
};

/// Where an instance lies in the atlas: bounds of its uv1.
struct Placement {
  std::string name;        ///< of the mesh, made unique among instances
  int node = 0, mesh = 0;  ///< indices into Lightmap::scene.instances and .meshes; both the same
  int source_mesh = 0;     ///< index into the meshes of the scene that was baked
  Vec2 min, max;           ///< in [0, 1], v down
};

/// How a light map came about.
struct Provenance {
  std::string source;      ///< file of the scene
  std::string integrator;  ///< gather, network or path
  std::string model;       ///< file of the network; empty without one
  std::string include;     ///< "indirect" or "full" (direct and indirect)
  std::string version;     ///< of lte
  std::string denoiser;    ///< with its version; empty where light was smoothed without one
  uint64_t seed = 0;
  double seconds = 0;           ///< of the whole bake
  double expected_error = 0;    ///< relative: root of the mean squared error over mean square light
  double texels_per_metre = 0;  ///< as the atlas came out
  double paths_per_texel = 0;   ///< mean over lit texels
  int64_t two_sided_texels = 0;  ///< lit on both sides, of which the brighter was taken
  int64_t metal_instances = 0;   ///< baked as matt
  int64_t kept_texels = 0;       ///< of an earlier bake, whose light has not changed
};

/// As records beside baked files have it.
nlohmann::json to_json(const Provenance& provenance);

struct Lightmap {
  int width = 0, height = 0;
  std::vector<Layer> layers;          ///< at least one
  std::vector<uint8_t> mask;          ///< [height, width] of Texel
  std::vector<Placement> placements;  ///< one an instance, in the order of scene.instances
  /// The scene that was baked, with a mesh of its own for each instance: instance i has mesh i.
  /// Triangles are those of the source mesh, in their order; vertices are split where charts part.
  /// uvs[1] has the place in the atlas, in [0, 1], v down. uvs[0] is never empty (where the source
  /// has none it repeats uvs[1]).
  scene::Scene scene;
  Provenance provenance;

  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  /// Sum over the layers, [height, width, 3].
  std::vector<float> total() const;
};

/// Writes all layers as a half-float EXR with ZIP compression: channels R, G, B are the sum over
/// layers, NAME.R, ... a layer's own where there are several. Values beyond the range of half are
/// held to it.
void write_lightmap_exr(const std::filesystem::path& path, const Lightmap& map);

/// Writes schema_version, size, units, layers, rectangles, provenance and mask counts.
/// @param image  file name of the light map beside it
/// @param units  what its values are
void write_lightmap_json(
    const std::filesystem::path& path, const Lightmap& map, const std::string& image,
    const std::string& units =
        "irradiance E in W/m^2, linear Rec.709; radiance of a surface: albedo E / pi");

/// A value that all but a thousandth of those above 0 are at or below, for pictures of 8 bits; 1
/// without any.
float bright(std::vector<float> values);

/// Writes map.scene with the light map on TEXCOORD_1 as MOZ_lightmap {index, texCoord: 1,
/// intensity}. The picture is a PNG inside the file: E / (π `intensity`) on the sRGB curve, the
/// intensity so that the brightest texels of all but a thousandth reach 1.
void write_lightmap_glb(const std::filesystem::path& path, const Lightmap& map);

/// Writes map.scene as a twin that every viewer shows alike: KHR_materials_unlit, base color times
/// E / π baked into a texture on TEXCOORD_1, without lights.
/// @param exposure  factor before the sRGB curve; 0: so that all but a thousandth of it fits
void write_unlit_glb(const std::filesystem::path& path, const Lightmap& map, double exposure = 0);

}  // namespace lte::bake
