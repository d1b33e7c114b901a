// Cameras as JSON, and the camera that a word of the command line means. docs/cameras.md has the
// format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::scene {

/// The `up` of a camera that names none: +Y; along the vertical, where that is no direction of the
/// picture, −Z for a view straight down and +Z for one straight up, so that +X stays at the right.
Vec3 default_up(const Vec3& view);

/// @throws lte::Error `what: "up" must not be ...` for a camera that sees nothing: a number that is
///         not finite, a view without direction, an angle out of range
void check_camera(const Camera& camera, const std::string& what);

/// Reads a camera file: {"origin":[..],"target":[..],"vfov":degrees} with "up", "name" and
/// "mirrored" as one likes; an array of such objects; what lte_render and `lte_datagen info` write
/// with --json; or an .exr that lte_render has written. A camera without a name has the file's.
/// @return  one camera or more
/// @throws lte::Error naming file and key.
std::vector<Camera> load_cameras(const std::filesystem::path& path);

/// The same for a file of one camera. @throws lte::Error also if it holds several.
Camera load_camera(const std::filesystem::path& path);

/// The camera as JSON on one line, as load_camera() reads it back bit for bit.
std::string camera_json(const Camera& camera);

/// The attribute of an OpenEXR file with the camera_json() of its picture.
inline constexpr const char* kCameraAttribute = "lteCamera";

/// What a camera flag asks for.
struct CameraChoice {
  std::vector<Camera> cameras;
  bool several = false;  ///< the word may stand for any number: "all", or a file with a list
};

/// The help of a flag that find_cameras() reads.
inline constexpr const char* kCameraHelp =
    "NAME or INDEX of a camera of the scene, all of them, auto (auto:1, auto:2, ... for other "
    "views from inside), or a FILE.json of "
    "{\"origin\":[..],\"target\":[..],\"vfov\":degrees}, \"up\" optional (docs/cameras.md)";

/// Finds what `word` stands for: "all" cameras of the scene, the one with this number (from 0) or
/// this name, or a camera file, which is a word that ends in .json or .exr or, where no camera is
/// called so, the name of any file.
/// @return  nothing for "auto" and "auto:NUMBER": pathtrace::auto_camera() makes that one
/// @throws lte::Error that lists the cameras of the scene if it is none of these, and for a name
///         that several cameras have.
std::optional<CameraChoice> find_cameras(const Scene& scene, const std::string& word);

/// The seed that a word asks of the automatic camera: N of "auto:N", else 0.
/// @throws lte::Error if something else than a number follows "auto:"
uint64_t auto_camera_seed(const std::string& word);

}  // namespace lte::scene
