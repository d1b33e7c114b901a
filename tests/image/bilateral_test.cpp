// The bilateral filter: what it leaves alone, what it never mixes, and how much noise it takes.
#include "lte/image/bilateral.h"

#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"

namespace lte::image {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Guides of a wall z = 0, a pixel a centimetre.
struct Wall {
  Wall(int width, int height) : normal(width, height, 3), position(width, height, 3) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        normal.set_rgb(x, y, {0, 0, 1});
        position.set_rgb(x, y, {0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0});
      }
    }
  }
  BilateralGuides guides() const { return {&normal, &position, nullptr}; }

  Image normal, position;
};

/// Grey values around 1, uniform, of this variance.
Image noise(int width, int height, double variance, uint64_t seed = 0) {
  Image out(width, height, 3);
  Rng random(seed);
  const auto half = static_cast<float>(std::sqrt(3 * variance));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = 1 + random.uniform(-half, half);
      out.set_rgb(x, y, {value, value, value});
    }
  }
  return out;
}

/// Variance of the red values at least `margin` from every side.
double variance_within(const Image& image, int margin) {
  double sum = 0, squares = 0, count = 0;
  for (int y = margin; y < image.height - margin; ++y) {
    for (int x = margin; x < image.width - margin; ++x) {
      const double value = image.at(x, y)[0];
      sum += value;
      squares += value * value;
      ++count;
    }
  }
  return (squares - sum * sum / count) / (count - 1);
}

TEST(Bilateral, LeavesConstantPicturesAsTheyAre) {
  const Wall wall(37, 21);
  Image light(37, 21, 3);
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 37; ++x) light.set_rgb(x, y, {0.25f, 3, 1e-3f});
  }
  const Image out = bilateral_filter(light, wall.guides(), {5, 4});
  for (size_t i = 0; i < light.pixels.size(); ++i)
    ASSERT_NEAR(out.pixels[i], light.pixels[i], 1e-5f * light.pixels[i]);
}

TEST(Bilateral, TakesNearlyAsMuchNoiseWhereNoShadowIs) {
  const Wall wall(160, 160);
  Image light = noise(160, 160, 0.01), variance(160, 160, 1);
  for (float& v : variance.pixels) v = 0.01f;
  for (const bool known : {true, false}) {
    BilateralGuides guides = wall.guides();
    if (known) guides.variance = &variance;
    const Image out = bilateral_filter(light, guides);
    EXPECT_LT(variance_within(out, 40), 0.02 * 0.01) << "variance known: " << known;
    double sum = 0;
    for (const float value : out.pixels) sum += value;
    EXPECT_NEAR(sum / static_cast<double>(out.pixels.size()), 1, 0.005);
  }
}

/// Two surfaces in each picture, of other light: none of it may cross.
TEST(Bilateral, NeverCrossesAnEdgeOfTheGuides) {
  Image light(64, 48, 3);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) light.set_rgb(x, y, x < 31 ? Rgb{1, 1, 1} : Rgb{5, 5, 5});
  }
  for (const char* edge : {"normal", "depth", "background"}) {
    Wall wall(64, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 31; x < 64; ++x) {
        if (edge == std::string("normal")) wall.normal.set_rgb(x, y, {0.6f, 0, 0.8f});
        if (edge == std::string("depth")) wall.position.at(x, y)[2] = -0.2f;
        if (edge == std::string("background")) wall.normal.set_rgb(x, y, {0, 0, 0});
      }
    }
    const Image out = bilateral_filter(light, wall.guides(), {4, 1e6f});
    for (size_t i = 0; i < light.pixels.size(); ++i)
      ASSERT_NEAR(out.pixels[i], light.pixels[i], 1e-5f * light.pixels[i]) << edge;
  }
}

TEST(Bilateral, KeepsTheEdgeOfAShadowThatStandsOutOfTheNoise) {
  const Wall wall(96, 64);
  Image light = noise(96, 64, 4e-4), variance(96, 64, 1);
  for (float& v : variance.pixels) v = 4e-4f;
  for (int y = 0; y < 64; ++y) {
    for (int x = 48; x < 96; ++x) {
      for (int c = 0; c < 3; ++c) light.at(x, y)[c] += 2;
    }
  }
  BilateralGuides guides = wall.guides();
  guides.variance = &variance;
  const Image out = bilateral_filter(light, guides);
  for (int y = 0; y < 64; ++y) {
    EXPECT_NEAR(out.at(47, y)[0], 1, 0.03);
    EXPECT_NEAR(out.at(48, y)[0], 3, 0.03);
  }
}

TEST(Bilateral, HasNoOtherNumbersThanItWasGiven) {
  Wall wall(33, 17);
  for (int y = 0; y < 17; ++y) {  // background has positions that mean nothing
    for (int x = 0; x < 9; ++x) {
      wall.normal.set_rgb(x, y, {0, 0, 0});
      wall.position.set_rgb(x, y, {kInfinity, 0, 0});
    }
  }
  Image light = noise(33, 17, 0.01), variance(33, 17, 1);
  for (size_t i = 0; i < variance.pixels.size(); ++i)
    variance.pixels[i] = i % 3 == 0 ? kInfinity : 0.01f;
  BilateralGuides guides = wall.guides();
  guides.variance = &variance;
  for (const float value : bilateral_filter(light, guides).pixels)
    ASSERT_TRUE(std::isfinite(value));
  const Wall point(1, 1);
  const Image one = noise(1, 1, 0.01);
  EXPECT_EQ(bilateral_filter(one, point.guides()).pixels, one.pixels);
}

TEST(Bilateral, DoesNotDependOnThreads) {
  const Wall wall(70, 50);
  const Image light = noise(70, 50, 0.01);
  const Image many = bilateral_filter(light, wall.guides());
  const int threads = num_threads();
  set_num_threads(1);
  const Image one = bilateral_filter(light, wall.guides());
  set_num_threads(threads);
  EXPECT_EQ(one.pixels, many.pixels);
}

TEST(Bilateral, NamesWhatIsWrong) {
  const Wall wall(8, 8), small(7, 8);
  const Image light = noise(8, 8, 0.01);
  const auto message = [&](const BilateralGuides& guides, const BilateralOptions& options = {}) {
    return [=, &light] { bilateral_filter(light, guides, options); };
  };
  EXPECT_THAT(message({&wall.normal, nullptr, nullptr}),
              ThrowsMessage<Error>(HasSubstr("needs positions")));
  EXPECT_THAT(message({&small.normal, &wall.position, nullptr}),
              ThrowsMessage<Error>(HasSubstr("normals of 7x8x3: expected 8x8x3")));
  EXPECT_THAT(message(wall.guides(), {-1, 4}), ThrowsMessage<Error>(HasSubstr("passes")));
  EXPECT_THAT(message(wall.guides(), {5, 0}), ThrowsMessage<Error>(HasSubstr("luminance_sigma")));
}

}  // namespace
}  // namespace lte::image
