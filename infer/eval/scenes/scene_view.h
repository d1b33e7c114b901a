// A scene of somebody's file, ready for pictures from one camera.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "infer/renderer/renderer.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/find_scenes.h"
#include "lte/scene/scene.h"

namespace lte::infer {

struct SceneView {
  std::string name;
  std::unique_ptr<const scene::Scene> scene;
  std::unique_ptr<Renderer> renderer;  ///< of `scene`
  scene::Camera camera;
  std::string camera_from;         ///< "camera file", "scene" or "automatic"
  std::vector<std::string> notes;  ///< light that was added, and what its file has in vain
};

/// Loads a scene. Its camera is that of its camera file, else its first one, else the automatic
/// one. A scene without light gets some, as --add-light auto gives it.
/// @throws lte::Error as load_scene(), and naming the camera file
SceneView load_view(const scene::FoundScene& file, const SceneFlags& loading, float aspect,
                    const std::shared_ptr<SharedDenoiser>& denoiser);

/// @throws lte::Error naming the camera file, where it cannot be that of this scene: it stands far
///         outside, or sees hardly anything, or nothing that is lit
void check_camera_file(const scene::FoundScene& file, const SceneView& view, float aspect);

/// Which pixels' irradiance counts, [height * width]: those whose centre sees a surface that is
/// no metal and emits nothing. Emitters count where hardly anything else is seen, as in a room
/// whose walls all glow.
std::vector<uint8_t> irradiance_mask(const SceneView& view, int width, int height);

}  // namespace lte::infer
