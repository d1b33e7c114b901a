#include <string>

#include "lte/bake/formats/assets.h"
#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"
#include "lte/base/check.h"

namespace lte::bake {
namespace {

constexpr const char* kGodotReadme = R"(Light map of {{source}} for Godot 4.

1. Copy this folder into your project. Godot imports scene.glb, whose second UV set is the place in
   the atlas, and lightmap.exr as a 2D array of one slice, by lightmap.exr.import.
2. Attach lightmap.gd to a Node3D of your scene and run it: it adds the scene and a LightmapGI.
   In the editor instead: add scene.glb's instance under the name Scene and a LightmapGI beside it,
   and give that lightmap.tres as its light data.
3. Lamps whose light is in the map must not light the scene again: their bake mode is Static.
Values are E / pi in linear Rec.709, without directions. No lightmap UVs may be generated at import
(Meshes > Light Baking stays Static). lightmap.json has rectangles and how the map came about.
)";

// As Godot's own baker writes it; a map of one slice, uncompressed so that no block shows.
constexpr const char* kGodotImport = R"([remap]

importer="2d_array_texture"
type="CompressedTexture2DArray"

[params]

compress/mode=3
compress/channel_pack=1
mipmaps/generate=false
slices/horizontal=1
slices/vertical=1
)";

constexpr const char* kGodotData = R"([gd_resource type="LightmapGIData" load_steps=2 format=3]

[ext_resource type="CompressedTexture2DArray" path="lightmap.exr" id="1"]

[resource]
lightmap_textures = Array[TextureLayered]([ExtResource("1")])
uses_spherical_harmonics = false
user_data = [{{users}}]
probe_data = {
"baked_exposure": 1.0,
"bounds": AABB({{bounds}}),
"bsp": PackedInt32Array(),
"interior": false,
"lightprobe_hash": 0,
"points": PackedVector3Array(),
"sh": PackedColorArray(),
"tetrahedra": PackedInt32Array()
}
_uses_packed_directional = false
)";

}  // namespace

void write_godot(const Lightmap& map, const FormatOptions&, FileSet* files) {
  write_radiosity_exr(map, files);
  files->write("lightmap.exr.import", kGodotImport);
  std::string nodes, users;
  for (size_t i = 0; i < map.placements.size(); ++i) {
    const std::string name = node_name(map, i), comma = i > 0 ? ", " : "";
    nodes += concat(comma, '"', name, '"');
    users += concat(comma, "NodePath(\"../Scene/", name, "\"), Rect2(0, 0, 1, 1), 0, -1");
  }
  const Bounds bounds = map.scene.bounds();
  const Vec3 low = bounds.low, extent = bounds.extent();
  const std::string box =
      concat(low.x, ", ", low.y, ", ", low.z, ", ", extent.x, ", ", extent.y, ", ", extent.z);
  files->write("lightmap.tres", filled(kGodotData, {{"users", users}, {"bounds", box}}));
  files->write("lightmap.gd", filled(k_godot_gd, {{"nodes", nodes}}));
  files->write("README.txt", filled(kGodotReadme, {{"source", map.provenance.source}}));
  write_scene_and_record(map, "lightmap.exr", kRadiosityUnits, files);
}

}  // namespace lte::bake
