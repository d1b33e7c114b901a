// Which pictures a command line of lte_render asks for.
#pragma once

#include <string>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {

struct View {
  scene::Camera camera;
  /// The picture's file, or the video's with the picture's number behind it: "turn.mp4#3"; empty if
  /// none is to be written.
  std::string out;
};

/// The cameras of the flag --camera (scene::find_cameras(); without it the scene's first camera,
/// else the automatic one) and a file for each.
///
/// Where the flag may stand for several cameras, `out` is a pattern: %d or, with leading zeros,
/// %04d becomes the number of the picture from 0, {name} the name of its camera, in which anything
/// but letters, digits, '.', '-' and '_' becomes '_'. Otherwise it is taken as it stands, and so is
/// the name of a video.
/// @param camera  auto:NUMBER is another automatic camera; no other seed moves it
/// @param aspect  width over height, for the automatic camera
/// @throws lte::Error for a camera that does not exist, a pattern that lacks where it is needed,
///         and two pictures of one name.
std::vector<View> choose_views(const pathtrace::Bvh& bvh, const std::string& camera,
                               const std::string& out, float aspect);

/// The cameras of --turntable (lte/pathtrace/placement/turntable.h), which begins with that of
/// --camera or, without it, with the automatic one. `out` is a pattern.
/// @throws lte::Error as choose_views(), and if the flag names several cameras.
std::vector<View> turntable_views(const pathtrace::Bvh& bvh, const std::string& camera, int count,
                                  const std::string& out, float aspect);

/// Those of the views, in order.
std::vector<scene::Camera> cameras_of(const std::vector<View>& views);

/// Refuses cameras that can see nothing at all: those whose pyramid of view misses the bounds of
/// the scene. A scene with an environment shows that instead.
/// @throws lte::Error naming the camera.
void check_in_view(const scene::Scene& scene, const Bounds& bounds, const std::vector<View>& views,
                   float aspect);

/// `pattern` with the number and the name put in; a video's name with the number behind it.
std::string picture_name(const std::string& pattern, size_t number, const std::string& name);

}  // namespace lte::infer
