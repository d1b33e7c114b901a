// The pixels of images with three channels as colors, where they lie.
#pragma once

#include <span>

#include "lte/image/image.h"

namespace lte::image {

static_assert(sizeof(Rgb) == 3 * sizeof(float), "three floats are a pixel");

inline std::span<Rgb> rgb_view(Image& image) {
  return {reinterpret_cast<Rgb*>(image.pixels.data()), image.pixels.size() / 3};
}
inline std::span<const Rgb> rgb_view(const Image& image) {
  return {reinterpret_cast<const Rgb*>(image.pixels.data()), image.pixels.size() / 3};
}

}  // namespace lte::image
