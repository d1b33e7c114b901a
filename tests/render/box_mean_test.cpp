// Box means against sums that are written out.
#include "lte/render/box_mean.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::render {
namespace {

TEST(BoxMean, IsTheMeanOverTheSquare) {
  constexpr int kWidth = 37, kHeight = 23;
  Rng rng(1, 0);
  std::vector<float> values(size_t{kWidth} * kHeight);
  std::vector<uint8_t> mask(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = rng.uniform() - 0.4f;
    mask[i] = rng.uniform() < 0.6f ? 1 : 0;
  }
  const BoxMean mean(kWidth, kHeight, mask);
  for (const int radius : {0, 1, 5, 22, 100}) {
    std::vector<float> counts;
    const std::vector<float> found = mean(values, radius, &counts);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        double sum = 0;
        int count = 0;
        for (int v = std::max(0, y - radius); v <= std::min(kHeight - 1, y + radius); ++v) {
          for (int u = std::max(0, x - radius); u <= std::min(kWidth - 1, x + radius); ++u) {
            const auto i = static_cast<size_t>(v * kWidth + u);
            if (mask[i]) sum += double{values[i]};
            count += mask[i];
          }
        }
        const auto i = static_cast<size_t>(y * kWidth + x);
        EXPECT_EQ(counts[i], static_cast<float>(count));
        EXPECT_NEAR(double{found[i]}, count > 0 ? sum / count : 0, 1e-6) << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace lte::render
