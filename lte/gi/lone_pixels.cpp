#include "lte/gi/lone_pixels.h"

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::gi {
namespace {

constexpr int64_t kPixels = 256;  // that a thread takes at a time

}  // namespace

std::vector<int32_t> first_of_blocks(const PixelSurfaces& surfaces, std::span<const int32_t> pixels,
                                     int side) {
  LTE_CHECK(side >= 1, "blocks of pixels: expected a side of at least 1, got ", side);
  const auto columns = static_cast<size_t>((surfaces.width + side - 1) / side);
  std::vector<int> last_row(columns, -1);  // of blocks, in which each column has had its pixel
  std::vector<int32_t> out;
  for (const int32_t pixel : pixels) {
    const int row = pixel / surfaces.width / side;
    int& last = last_row[static_cast<size_t>(pixel % surfaces.width / side)];
    if (last == row) continue;
    last = row;
    out.push_back(pixel);
  }
  return out;
}

std::vector<int32_t> share_answers(const PixelSurfaces& surfaces, std::span<const int32_t> pixels,
                                   std::span<const uint8_t> answered, int radius,
                                   std::span<const std::span<Rgb>> layers) {
  const size_t count = layers.size();
  std::vector<Rgb> mean(pixels.size() * count);
  std::vector<float> total(pixels.size());
  parallel_for(static_cast<int64_t>(pixels.size()), kPixels, [&](int64_t begin, int64_t end) {
    for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
      const SurfacePoint point = point_of(surfaces, static_cast<size_t>(pixels[k]));
      const int x = pixels[k] % surfaces.width, y = pixels[k] / surfaces.width;
      for (int j = std::max(0, y - radius); j <= std::min(y + radius, surfaces.height - 1); ++j) {
        for (int i = std::max(0, x - radius); i <= std::min(x + radius, surfaces.width - 1); ++i) {
          const size_t source = surfaces.at(i, j);
          const float weight = answered[source] ? similarity(surfaces, point, source) : 0;
          if (!(weight > 0)) continue;
          total[k] += weight;
          for (size_t layer = 0; layer < count; ++layer)
            mean[k * count + layer] += layers[layer][source] * weight;
        }
      }
    }
  });
  std::vector<int32_t> none;
  for (size_t k = 0; k < pixels.size(); ++k) {
    if (!(total[k] > 0)) {
      none.push_back(pixels[k]);
      continue;
    }
    for (size_t layer = 0; layer < count; ++layer)
      layers[layer][static_cast<size_t>(pixels[k])] = mean[k * count + layer] / total[k];
  }
  return none;
}

}  // namespace lte::gi
