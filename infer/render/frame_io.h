// Frames on disk: EXR with layers for programs, PNG for people.
#pragma once

#include <filesystem>

#include "infer/renderer/render_settings.h"
#include "lte/image/display_picture.h"
#include "lte/image/tone_curve.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Chooses the exposure for a PNG of this frame by its surfaces, not by what is behind them: 1 for
/// outputs that are not light, and for a black picture.
float frame_exposure(const Frame& frame, Output output);

/// Writes a frame by the extension of `path`.
///
/// An .exr holds the output as R, G, B and the layers albedo, normal, depth and emission, with
/// direct and indirect where the output needed them; all linear and not exposed. With a
/// camera, its header has that as JSON too (scene/load_camera.h). In a .png light is exposed and
/// goes through the tone curve and sRGB, albedo goes through sRGB alone, normals map [−1, 1] to
/// [0, 1], and depth is divided by its largest value.
/// @throws lte::Error if the extension is another or the file cannot be written.
void write_frame(const std::filesystem::path& path, const Frame& frame, Output output,
                 float exposure, const scene::Camera* camera = nullptr,
                 image::ToneCurve curve = image::ToneCurve::Linear);

/// What a .png of the frame shows, in three channels.
image::DisplayPicture display_frame(const Frame& frame, Output output, float exposure,
                                    image::ToneCurve curve);

/// Whether write_frame() writes layers to this path: an .exr.
bool keeps_layers(const std::filesystem::path& path);

/// Whether the name ends in ".exr" or ".png", in upper or lower case.
bool is_picture_path(const std::filesystem::path& path);

}  // namespace lte::infer
