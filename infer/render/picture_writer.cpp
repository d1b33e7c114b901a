#include "infer/render/picture_writer.h"

#include <utility>

#include "infer/render/frame_io.h"
#include "lte/base/timer.h"

namespace lte::infer {

PictureWriter::PictureWriter(std::function<void(const FinishedPicture&)> written, Video* video)
    : written_(std::move(written)), video_(video) {}

PictureWriter::~PictureWriter() {
  if (busy_.valid()) busy_.wait();
}

void PictureWriter::write(FinishedPicture picture) {
  finish();
  picture_ = std::move(picture);
  busy_ = std::async(std::launch::async, [&p = *picture_, video = video_] {
    const Timer timer;
    if (video != nullptr) {
      video->add(display_frame(p.frame, p.output, p.exposure, p.curve));
    } else {
      write_frame(p.out, p.frame, p.output, p.exposure, &p.camera, p.curve);
    }
    return timer.seconds();
  });
}

void PictureWriter::finish() {
  if (!busy_.valid()) return;
  seconds_ += busy_.get();
  written_(*picture_);
  picture_.reset();
}

}  // namespace lte::infer
