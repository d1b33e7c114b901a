// Scene export, so that any glTF viewer opens what the generator makes.
#pragma once

#include <filesystem>
#include <functional>

#include "lte/scene/scene.h"

namespace lte::scene {

/// Writes a .glb (binary glTF 2.0): meshes, instances as nodes, base colors, metal, textures as
/// PNG, emission with KHR_materials_emissive_strength, punctual lights, cameras. Atomic.
/// load_scene() of the file gives the same scene, but for its environment: glTF has none.
void write_glb(const std::filesystem::path& path, const Scene& scene);

class GlbWriter;
/// The same with a last change to the document: extensions that a scene has no place for. Image i
/// is texture i of the scene, material i its material i.
void write_glb(const std::filesystem::path& path, const Scene& scene,
               const std::function<void(GlbWriter&)>& change);

}  // namespace lte::scene
