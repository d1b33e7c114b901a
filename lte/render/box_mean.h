// Means over squares of pixels, of some pixels of a picture: local statistics.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lte::render {

class BoxMean {
 public:
  /// @param mask  [height * width], not 0 in the pixels that count; must outlive it
  BoxMean(int width, int height, std::span<const uint8_t> mask);

  /// The mean over the square of 2 radius + 1 pixels around each pixel, of those that count; 0
  /// where none does. The time does not grow with the radius.
  /// @param values  [height * width], finite
  /// @param counts  how many count there; may be null
  /// @note The same for any number of threads.
  std::vector<float> operator()(std::span<const float> values, int radius,
                                std::vector<float>* counts = nullptr) const;

 private:
  int width_, height_;
  std::span<const uint8_t> mask_;
};

}  // namespace lte::render
