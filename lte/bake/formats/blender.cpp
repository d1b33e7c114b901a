#include "lte/bake/formats/assets.h"
#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"

namespace lte::bake {
namespace {

constexpr const char* kBlenderReadme = R"(Light map of {{source}} for Blender (4.0 or newer).

Run `blender --python import.py` here: it opens scene.glb and gives every material the light map.
The second UV layer of each mesh is its place in lightmap.exr, half floats, linear Rec.709, E / pi:
what a white diffuse surface sends out. import.py multiplies it by the base color and shows the
product as emission, so that no lamp is needed and Cycles is done after a few samples.

By hand: add an Image Texture of lightmap.exr (Linear Rec.709, Extend) on the UV map UVMap.001,
multiply it by the base color, and connect the product to an Emission of strength 1.
lightmap.json has the rectangle of each mesh and how the map came about.
)";

}  // namespace

void write_blender(const Lightmap& map, const FormatOptions&, FileSet* files) {
  write_radiosity_exr(map, files);
  files->write("import.py", k_blender_py);
  files->write("README.txt", filled(kBlenderReadme, {{"source", map.provenance.source}}));
  write_scene_and_record(map, "lightmap.exr", kRadiosityUnits, files);
}

}  // namespace lte::bake
