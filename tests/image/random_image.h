// A picture of noise for the tests.
#pragma once

#include "lte/base/random.h"
#include "lte/image/image.h"

namespace lte::test {

inline image::Image random_image(int width, int height, int channels, uint64_t seed, float low = 0,
                                 float high = 1) {
  image::Image out(width, height, channels);
  Rng rng(seed);
  for (float& value : out.pixels) value = rng.uniform(low, high);
  return out;
}

}  // namespace lte::test
