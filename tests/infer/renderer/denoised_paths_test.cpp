// Corrected pictures drawn towards denoised paths: made-up errors and noise whose truth is known.
#include "infer/renderer/denoised_paths.h"

#include <cmath>

#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kSide = 96;
constexpr float kAlbedo = 0.5f;

/// A wall that fills the picture.
struct Wall {
  SurfaceGuides guides;
  std::vector<PixelKind> kinds = std::vector<PixelKind>(kSide * kSide, PixelKind::Smooth);
  std::vector<int32_t> paths = std::vector<int32_t>(kSide * kSide, 8);

  Wall() {
    guides.normal = guides.position = guides.albedo = Image(kSide, kSide, 3);
    guides.mask.assign(kSide * kSide, 1);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        guides.normal.set_rgb(x, y, {0, 0, 1});
        guides.position.set_rgb(x, y,
                                {0.05f * static_cast<float>(x), 0.05f * static_cast<float>(y), 0});
        guides.albedo.set_rgb(x, y, {kAlbedo, kAlbedo, kAlbedo});
      }
    }
  }
};

/// Irradiance, half of it direct.
Frame frame_of(const Wall& wall, const Image& irradiance) {
  Frame out;
  out.albedo = wall.guides.albedo;
  out.mean_normal = wall.guides.normal;
  out.emission = Image(kSide, kSide, 3);
  out.direct = out.indirect = irradiance;
  for (Image* layer : {&out.direct, &out.indirect})
    for (float& value : layer->pixels) value /= 2;
  return out;
}

/// What paths find of it, with noise of a standard deviation of `noise` of the mean.
std::array<pathtrace::RadianceLayers, 2> halves_of(const Image& irradiance, float noise) {
  std::array<pathtrace::RadianceLayers, 2> out;
  for (size_t h = 0; h < 2; ++h) {
    Image radiance = irradiance;
    for (size_t k = 0; k < radiance.pixels.size(); ++k) {
      Rng random(h + 1, k);
      const float deviate = std::sqrt(3.0f) * (2 * random.uniform() - 1);
      radiance.pixels[k] *= kAlbedo / kPi / 2 * (1 + noise * deviate);
    }
    out[h] = {Image(kSide, kSide, 3), radiance, radiance};
  }
  return out;
}

double rms(const Frame& frame, const Image& truth) {
  double sum = 0;
  for (size_t k = 0; k < truth.pixels.size(); ++k) {
    const double error =
        double{frame.direct.pixels[k]} + double{frame.indirect.pixels[k]} - double{truth.pixels[k]};
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(truth.pixels.size()));
}

Image gradient() {
  Image out(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float light = 2 + std::sin(0.05f * static_cast<float>(x + y));
      out.set_rgb(x, y, {light, light, light});
    }
  }
  return out;
}

TEST(DenoisedPaths, WhatIsWrongIsDrawnToThem) {
  const Wall wall;
  const Image truth = gradient();
  Image wrong = truth;
  for (size_t k = 0; k < wrong.pixels.size(); ++k) {
    Rng random(7, k / 3);
    wrong.pixels[k] *= 1.1f + 0.2f * random.uniform();
  }
  Frame frame = frame_of(wall, wrong);
  const double before = rms(frame, truth);
  draw_to_denoised(image::Denoiser(), wall.guides, wall.kinds, wall.paths, halves_of(truth, 0.5f),
                   &frame);
  EXPECT_LT(rms(frame, truth), 0.3 * before);
}

/// Direct light is right, and paths know less of it than of indirect light.
TEST(DenoisedPaths, IndirectLightAloneIsMendedBesideDirectLightThatIsRight) {
  const Wall wall;
  const Image truth = gradient();
  Frame frame = frame_of(wall, truth);
  auto halves = halves_of(truth, 0.5f);
  for (size_t k = 0; k < truth.pixels.size(); ++k) {
    Rng random(7, k / 3);
    frame.indirect.pixels[k] *= 1.1f + 0.2f * random.uniform();
    for (size_t h = 0; h < 2; ++h) {
      Rng noise(8 + h, k);
      halves[h].direct.pixels[k] = truth.pixels[k] * kAlbedo / kPi * noise.uniform();
    }
  }
  const double before = rms(frame, truth);
  draw_to_denoised(image::Denoiser(), wall.guides, wall.kinds, wall.paths, halves, &frame);
  EXPECT_LT(rms(frame, truth), 0.5 * before);
}

TEST(DenoisedPaths, WhatIsRightStaysWhereTheDenoiserErrs) {
  const Wall wall;
  Image truth = gradient();  // with stripes that no guide tells of, fainter than the noise
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float factor = x % 4 < 2 ? 1.25f : 0.75f;
      truth.set_rgb(x, y, truth.rgb(x, y) * factor);
    }
  }
  const auto halves = halves_of(truth, 1.0f);
  const image::Denoiser denoiser;
  Image found = halves[0].direct;
  for (float& value : found.pixels) value *= 2;
  const Image smooth =
      denoise_reflected(denoiser, wall.guides, found, {wall.guides.albedo, wall.guides.normal});
  double blurred = 0;
  for (size_t k = 0; k < truth.pixels.size(); ++k) {
    const double error = double{smooth.pixels[k] * kPi / kAlbedo} - double{truth.pixels[k]};
    blurred += error * error;
  }
  blurred = std::sqrt(blurred / static_cast<double>(truth.pixels.size()));
  ASSERT_GT(blurred, 0.1) << "the denoiser has kept the stripes: the test tells nothing";
  Frame frame = frame_of(wall, truth);
  draw_to_denoised(denoiser, wall.guides, wall.kinds, wall.paths, halves, &frame);
  EXPECT_LT(rms(frame, truth), 0.1 * blurred);
}

TEST(DenoisedPaths, PixelsWithoutPathsAndThoseThatAreFixedKeepEveryBit) {
  Wall wall;
  for (size_t i = 0; i < wall.kinds.size(); ++i) {
    if (i % 3 == 1) wall.kinds[i] = PixelKind::Fixed;
    if (i % 3 == 2) wall.paths[i] = 0;
  }
  Image dark = gradient();
  for (float& value : dark.pixels) value *= 0.2f;
  const Frame before = frame_of(wall, dark);
  Frame after = before;
  draw_to_denoised(image::Denoiser(), wall.guides, wall.kinds, wall.paths,
                   halves_of(gradient(), 0.1f), &after);
  for (size_t k = 0; k < dark.pixels.size(); ++k) {
    if (k / 3 % 3 == 0) {
      EXPECT_NE(after.direct.pixels[k], before.direct.pixels[k]);
    } else {
      ASSERT_EQ(after.direct.pixels[k], before.direct.pixels[k]);
      ASSERT_EQ(after.indirect.pixels[k], before.indirect.pixels[k]);
    }
  }
}

TEST(DenoisedPaths, BlackStaysBlackAndOtherSizesAreRefused) {
  const Wall wall;
  const Image black(kSide, kSide, 3);
  Frame frame = frame_of(wall, black);
  const auto halves = halves_of(black, 0.5f);
  draw_to_denoised(image::Denoiser(), wall.guides, wall.kinds, wall.paths, halves, &frame);
  EXPECT_EQ(frame.direct.pixels, black.pixels);
  const std::vector<int32_t> fewer(wall.paths.size() - 1);
  EXPECT_THROW(draw_to_denoised(image::Denoiser(), wall.guides, wall.kinds, fewer, halves, &frame),
               Error);
}

/// A lamp's light runs over its edges where a denoiser sees it.
TEST(DenoisedPaths, AReferenceWithoutNoiseKeepsTheEdgesOfLamps) {
  scene::Scene scene = test::furnished_room();
  const int glow = test::add_material(&scene, {0, 0, 0}, {60, 60, 60});
  test::add_quad(&scene, {1.5f, 1, -0.1f}, {0, 0.23f, 0.05f}, {0, 0.04f, 0.31f}, glow);
  Renderer renderer(scene);
  RenderSettings settings;
  settings.mode = Mode::Reference;
  settings.width = 64;
  settings.height = 48;
  const scene::Camera camera{"in", {3.8f, 1.2f, 0.2f}, {0, 1, 0.2f}, {0, 1, 0}, 70};
  const auto picture = [&](int paths, uint64_t seed, Denoise denoise) {
    settings.spp = paths;
    settings.seed = seed;
    settings.denoise = denoise;
    return renderer.render(camera, settings).color;
  };
  const Image wanted = picture(1024, 3, Denoise::Off);
  const auto error = [&](const Image& found) {
    double sum = 0, relative = 0;
    for (size_t k = 0; k < wanted.pixels.size(); ++k) {
      const double difference = double{found.pixels[k]} - double{wanted.pixels[k]};
      sum += difference * difference;
      relative +=
          difference * difference / (double{wanted.pixels[k]} * double{wanted.pixels[k]} + 0.01);
    }
    return std::pair(sum, relative);
  };
  float brightest = 0;
  for (const float value : wanted.pixels) brightest = std::max(brightest, value);
  ASSERT_GT(brightest, 20) << "the lamp is not in the picture";
  const auto noisy = error(picture(16, 4, Denoise::Off)),
             smooth = error(picture(16, 4, Denoise::On));
  EXPECT_LT(smooth.first, 1.02 * noisy.first) << "squared";
  EXPECT_LT(smooth.second, 0.5 * noisy.second) << "relative";
}

}  // namespace
}  // namespace lte::infer
