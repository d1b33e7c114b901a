#include "lte/bake/formats/formats.h"

#include <array>

namespace lte::bake {

std::span<const Format> engine_formats() {
  static constexpr std::array<Format, 5> kFormats{{
      {"bevy", "scene.glb and a KTX2 texture for Bevy's Lightmap", write_bevy},
      {"blender", "scene.glb, an EXR and a script that opens both", write_blender},
      {"godot", "scene.glb, an EXR and LightmapGIData for Godot 4", write_godot},
      {"three", "a page by three.js (--three FILE) with its assets", write_three},
      {"vertex-colors", "scene.glb with the light in COLOR_0, without a picture",
       write_vertex_colors},
  }};
  return kFormats;
}

}  // namespace lte::bake
