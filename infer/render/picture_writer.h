// Writes pictures while the next ones are made: encoding a PNG keeps one processor busy, and parts
// of a picture do no more.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <optional>

#include "infer/render/video.h"
#include "infer/renderer/render_settings.h"
#include "lte/image/tone_curve.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// A picture as write_frame() takes it.
struct FinishedPicture {
  std::filesystem::path out;
  Frame frame;
  Output output = Output::Full;
  float exposure = 1;
  scene::Camera camera;
  image::ToneCurve curve = image::ToneCurve::Linear;  ///< of a .png
};

/// Keeps one picture at most, and writes them in their order.
class PictureWriter {
 public:
  /// @param written  called with each picture once it is written, in the caller's thread
  /// @param video    where pictures go, borrowed; null: each into the file that it names
  explicit PictureWriter(std::function<void(const FinishedPicture&)> written,
                         Video* video = nullptr);
  /// Waits. What goes wrong here is lost: finish() says it.
  ~PictureWriter();
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;

  /// Waits for the picture before, and begins with this one.
  /// @throws lte::Error if the one before could not be written
  void write(FinishedPicture picture);
  /// Waits for the last one.
  /// @throws lte::Error if it could not be written
  void finish();

  /// That writing has taken, beside other work or not.
  double seconds() const { return seconds_; }

 private:
  std::function<void(const FinishedPicture&)> written_;
  Video* video_;
  std::optional<FinishedPicture> picture_;
  std::future<double> busy_;  ///< the seconds that it takes
  double seconds_ = 0;
};

}  // namespace lte::infer
