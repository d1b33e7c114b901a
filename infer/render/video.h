// A video of several pictures, encoded by the program ffmpeg.
//
// ffmpeg runs beside this process and takes 8-bit pictures as they are made, through a socket: the
// bytes that a PNG would hold, in their order. It writes to a temporary name, so that a video
// appears whole or not at all.
#pragma once

#include <filesystem>
#include <optional>

#include "lte/base/child_process.h"
#include "lte/base/file.h"
#include "lte/image/display_picture.h"

namespace lte::infer {

/// Whether the name ends in ".mp4", ".webm" or ".gif", in upper or lower case.
bool is_video_path(const std::filesystem::path& path);

/// Before any work for a video.
/// @throws lte::Error if no ffmpeg is on PATH, or an .mp4 would have an odd side
void check_video(const std::filesystem::path& path, int width, int height);

class Video {
 public:
  /// Starts ffmpeg. @throws lte::Error as check_video(), or if it does not start
  Video(const std::filesystem::path& path, int width, int height, int pictures_a_second);
  /// Without finish() nothing is left behind.
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// @throws lte::Error with ffmpeg's own words if it has ended
  void add(const image::DisplayPicture& picture);
  /// Waits for ffmpeg; the file is there afterwards.
  /// @throws lte::Error with ffmpeg's own words if it failed
  void finish();

 private:
  [[noreturn]] void fail();
  int wait();

  std::filesystem::path path_;
  int width_, height_;
  AtomicFile file_;
  int input_ = -1, words_ = -1;  ///< descriptors: ffmpeg's input, and what it says
  std::optional<ChildProcess> ffmpeg_;
};

}  // namespace lte::infer
