#include "lte/gi/lone_pixels.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "tests/gi/planes.h"

namespace lte::gi {
namespace {

using test::PlanePicture;

TEST(LonePixels, EveryBlockThatHasAnyGivesItsFirst) {
  const PlanePicture picture(23, 17, {test::tilted_wall()});
  const PixelSurfaces surfaces = picture.view();
  Rng rng(3);
  std::vector<int32_t> pixels;
  for (int32_t i = 0; i < 23 * 17; ++i) {
    if (rng.uniform() < 0.2) pixels.push_back(i);
  }
  EXPECT_EQ(first_of_blocks(surfaces, pixels, 1), pixels);
  EXPECT_THROW(first_of_blocks(surfaces, pixels, 0), Error);
  for (const int side : {2, 3, 40}) {
    std::set<std::pair<int, int>> seen;
    std::vector<int32_t> expected;
    for (const int32_t pixel : pixels) {
      if (seen.insert({pixel % 23 / side, pixel / 23 / side}).second) expected.push_back(pixel);
    }
    EXPECT_EQ(first_of_blocks(surfaces, pixels, side), expected) << side;
  }
}

TEST(LonePixels, AnswersAreMeansOverTheirSurface) {
  // Two planes: nothing may cross from one to the other.
  const PlanePicture picture(40, 30, test::wall_and_plate(0.8f));
  const PixelSurfaces surfaces = picture.view();
  std::vector<int32_t> all(surfaces.size());
  std::iota(all.begin(), all.end(), 0);
  Rng rng(7);
  std::vector<uint8_t> answered(surfaces.size());
  std::vector<Rgb> first(surfaces.size(), Rgb{-1, -1, -1}), second = first;
  for (size_t i = 0; i < answered.size(); ++i) {
    if (rng.uniform() > 0.1) continue;
    answered[i] = 1;
    first[i] = {rng.uniform(), rng.uniform(), rng.uniform()};
    second[i] = first[i] * 2;
  }
  const std::vector<Rgb> before = first;
  constexpr int kRadius = 2;
  const auto share = [&](int threads) {
    set_num_threads(threads);
    std::vector<Rgb> a = before, b = second;
    const std::vector<std::span<Rgb>> layers = {a, b};
    const std::vector<int32_t> none = share_answers(surfaces, all, answered, kRadius, layers);
    set_num_threads(0);
    return std::tuple(a, b, none);
  };
  const auto [mean, doubled, none] = share(1);
  EXPECT_EQ(share(3), std::tuple(mean, doubled, none));
  EXPECT_THAT(none, testing::Not(testing::IsEmpty()));
  for (size_t i = 0; i < surfaces.size(); ++i) {
    const int x = static_cast<int>(i) % 40, y = static_cast<int>(i) / 40;
    double sum = 0, count = 0;  // both planes face the camera: similarity is 1 or 0
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) {
        const size_t other = surfaces.at(u, v);
        if (std::max(std::abs(u - x), std::abs(v - y)) > kRadius || !answered[other]) continue;
        if (picture.plane[other] != picture.plane[i]) continue;
        sum += double{before[other].y};
        count += 1;
      }
    }
    const bool left = std::binary_search(none.begin(), none.end(), static_cast<int32_t>(i));
    ASSERT_EQ(left, count == 0) << i;
    if (left) {
      EXPECT_EQ(mean[i], before[i]) << i;
      continue;
    }
    EXPECT_NEAR(mean[i].y, sum / count, 1e-5) << i;
    EXPECT_NEAR(doubled[i].y, 2 * sum / count, 2e-5) << i;
  }
}

}  // namespace
}  // namespace lte::gi
