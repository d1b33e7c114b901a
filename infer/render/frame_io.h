// Frames on disk: EXR with layers for programs, PNG for people.
#pragma once

#include <filesystem>

#include "infer/common/renderer.h"

namespace lte::infer {

/// Exposure that a PNG of this frame gets by itself: 1 for outputs that are not light, or for a
/// black picture.
float frame_exposure(const Frame& frame, Output output);

/// By the extension. .exr: the output as R, G, B and the layers albedo, normal, depth, emission,
/// and direct, indirect or total where the output needed them; linear, not exposed. .png: light is
/// exposed and goes through the sRGB curve, albedo through the curve alone, normals map [−1, 1] to
/// [0, 1], depth is divided by its largest value.
/// @throws lte::Error if the extension is another or the file cannot be written.
void write_frame(const std::filesystem::path& path, const Frame& frame, Output output,
                 float exposure);

/// ".exr" or ".png" in any case.
bool is_picture_path(const std::filesystem::path& path);

}  // namespace lte::infer
