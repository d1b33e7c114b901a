// Light maps as the files that an engine takes.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "lte/bake/lightmap.h"
#include "lte/bake/probes.h"
#include "lte/bake/vertex_light.h"
#include "lte/base/file_set.h"

namespace lte::bake {

struct FormatOptions {
  /// An ES module that exports three.js (itself, or as THREE), GLTFLoader and OrbitControls.
  std::filesystem::path three;
  const ProbeVolume* probes = nullptr;  ///< of --probes; may be null
  VertexOptions vertex{};               ///< of vertex-colors
};

/// One engine's files. Writers add them to a set, which the caller commits: scene.glb, the light
/// in the engine's form, and a README.txt that says how to use both.
struct Format {
  std::string_view name;     ///< of --format
  std::string_view purpose;  ///< one line
  void (*write)(const Lightmap& map, const FormatOptions& options, FileSet* files);
};

/// In the order of their names.
std::span<const Format> engine_formats();

/// index.html shows the scene in a browser; E as half floats, a slider a layer.
/// @throws lte::Error naming --three unless it is there and exports what the page needs.
void write_three(const Lightmap& map, const FormatOptions& options, FileSet* files);
/// LightmapGIData of Godot 4; E / π as EXR.
void write_godot(const Lightmap& map, const FormatOptions& options, FileSet* files);
/// Lightmap of Bevy; E / π as KTX2, RGB9E5. With probes an IrradianceVolume, too.
void write_bevy(const Lightmap& map, const FormatOptions& options, FileSet* files);
/// A script that opens the scene in Blender; E / π as EXR.
void write_blender(const Lightmap& map, const FormatOptions& options, FileSet* files);
/// A scene without a picture: light times the surface's own color in COLOR_0, which viewers
/// multiply by the base color (KHR_materials_unlit), and E in _IRRADIANCE. Of several layers each
/// has its part of COLOR_0 as _LIGHT_NAME, too.
void write_vertex_colors(const Lightmap& map, const FormatOptions& options, FileSet* files);

}  // namespace lte::bake
