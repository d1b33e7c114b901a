#include "lte/image/image.h"

namespace lte::image {

Image::Image(int width_, int height_, int channels_)
    : width(width_), height(height_), channels(channels_) {
  LTE_CHECK(width > 0 && height > 0 && channels > 0, "image: expected positive sizes, got ", width,
            " x ", height, " with ", channels, " channels");
  pixels.resize(static_cast<size_t>(width) * static_cast<size_t>(height) *
                static_cast<size_t>(channels));
}

}  // namespace lte::image
