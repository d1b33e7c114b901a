// A video of numbered pictures, by the system's ffmpeg.
#pragma once

#include <filesystem>
#include <string>

namespace lte::infer {

/// Whether a name ends in one of the containers that make_video() writes: .mp4, .webm, .mkv, .gif.
bool is_video_path(const std::filesystem::path& path);

/// Makes a video of the pictures of a pattern with %d or %04d, numbered from 0.
/// @return  false, with a line in the log, if there is no ffmpeg on the PATH
/// @throws lte::Error if ffmpeg fails; nothing is left of the video then
bool make_video(const std::string& pattern, double fps, const std::filesystem::path& video);

}  // namespace lte::infer
