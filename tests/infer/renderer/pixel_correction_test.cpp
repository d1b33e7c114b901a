// Pictures corrected by paths through their pixels: closed forms, made-up errors, and the path
// tracer's own pictures.
#include "infer/renderer/pixel_correction.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "infer/renderer/pixel_paths.h"
#include "infer/renderer/renderer.h"
#include "tests/infer/fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr float kAlbedo = 0.6f;

/// A closed box of radiance 1 at every wall.
scene::Scene furnace() {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {kAlbedo, kAlbedo, kAlbedo}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  return scene;
}

scene::Camera in_the_furnace() { return {"in", {0.5f, 0, 0}, {-1, 0.1f, 0}, {0, 1, 0}, 90}; }

scene::Camera into_the_room() { return {"in", {3.8f, 1.2f, 0.2f}, {0, 1, 0.2f}, {0, 1, 0}, 70}; }

RenderSettings gathered(int width, int height, int paths) {
  RenderSettings out;
  out.indirect = Indirect::Gather;
  out.gather.rays = 8;
  out.correction_paths = paths;
  out.direct_samples = 8;
  out.denoise = Denoise::Auto;
  out.width = width;
  out.height = height;
  return out;
}

/// Relative, as docs/metrics.md has it: both over the reference's mean.
double relative_mse(const Image& picture, const Image& reference) {
  double mean = 0, sum = 0;
  for (const float value : reference.pixels) mean += double{value};
  mean /= static_cast<double>(reference.pixels.size());
  for (size_t k = 0; k < picture.pixels.size(); ++k) {
    const double x = double{picture.pixels[k]} / mean, y = double{reference.pixels[k]} / mean;
    sum += (x - y) * (x - y) / (y * y + 0.01);
  }
  return sum / static_cast<double>(picture.pixels.size());
}

/// In the box, what a camera sees after depth reflections is the geometric sum of albedos.
TEST(PixelCorrection, AWrongPictureOfAFurnaceFallsToItsClosedForm) {
  const scene::Scene scene = furnace();
  Renderer renderer(scene);
  renderer.make_table({});
  const scene::Camera camera = in_the_furnace();
  constexpr int kWidth = 48, kHeight = 36;
  Frame wrong = renderer.render(camera, gathered(kWidth, kHeight, 0));
  for (Image* layer : {&wrong.direct, &wrong.indirect})
    for (float& value : layer->pixels) value *= 1.4f;
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(renderer.bvh(), camera, kWidth, kHeight);
  const std::vector<PixelKind> kinds =
      pixel_kinds(hits, pathtrace::pixel_size(camera, kHeight), false);
  const double expected = test::geometric_sum(double{kAlbedo}, 6);
  double before = 1;
  for (const int count : {4, 32, 256}) {
    PixelPaths paths(renderer.bvh(), renderer.lights(), camera, {kWidth, kHeight, 0, kHeight}, 5,
                     9);
    std::vector<int64_t> all(kinds.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int64_t>(i);
    paths.add(all, count);
    EXPECT_DOUBLE_EQ(paths.mean_paths(), 2 * count);
    Frame frame = wrong;
    correct_pixels(guides_of(hits), kinds, paths.paths(), paths.take(), &frame);
    double sum = 0, squares = 0;
    for (size_t k = 0; k < frame.albedo.pixels.size(); ++k) {
      const double seen = double{frame.emission.pixels[k]} +
                          double{frame.albedo.pixels[k]} / double{kPi} *
                              (double{frame.direct.pixels[k]} + double{frame.indirect.pixels[k]});
      sum += seen;
      squares += (seen / expected - 1) * (seen / expected - 1);
    }
    const auto n = static_cast<double>(frame.albedo.pixels.size());
    EXPECT_NEAR(sum / n, expected, 0.02 * expected) << count << " paths";
    EXPECT_LT(squares / n, 0.7 * before) << count << " paths";
    before = squares / n;
  }
  EXPECT_LT(std::sqrt(before), 0.03);
}

/// @param settings  of so many correcting paths, whose answers are wrong
void expect_it_tends_to_the_reference(Renderer& renderer,
                                      const std::function<RenderSettings(int paths)>& settings) {
  RenderSettings reference = settings(0);
  reference.mode = Mode::Reference;
  reference.denoise = Denoise::Off;
  reference.spp = 1024;
  reference.seed = 77;
  const Image wanted = renderer.render(into_the_room(), reference).color;
  const double uncorrected =
      relative_mse(renderer.render(into_the_room(), settings(0)).color, wanted);
  double before = uncorrected;
  for (const int count : {8, 64, 512}) {
    const Frame frame = renderer.render(into_the_room(), settings(count));
    EXPECT_DOUBLE_EQ(frame.correction_paths, count);
    reference.spp = count;
    reference.seed = 78;
    const double noise = relative_mse(renderer.render(into_the_room(), reference).color, wanted);
    const double now = relative_mse(frame.color, wanted);
    EXPECT_LT(now, 1.05 * noise) << count << " paths";
    EXPECT_LT(now, 0.8 * before) << count << " paths";
    before = now;
  }
  EXPECT_LT(before, 0.25 * uncorrected);
}

TEST(PixelCorrection, APictureOfARoomTendsToTheReference) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  TableSettings poor;
  poor.entries = 64;
  poor.paths = 2;
  renderer.make_table(poor);
  expect_it_tends_to_the_reference(renderer, [](int paths) { return gathered(48, 36, paths); });
}

TEST(PixelCorrection, SoDoesThatOfANetworkWithoutTraining) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
  for (const Denoise denoise : {Denoise::Auto, Denoise::On}) {  // direct light with noise, without
    expect_it_tends_to_the_reference(renderer, [denoise](int paths) {
      RenderSettings out;
      out.width = 48;
      out.height = 36;
      out.denoise = denoise;
      out.correction_paths = paths;
      return out;
    });
  }
}

TEST(PixelCorrection, LayersStillAddUpToThePicture) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  const Frame frame = renderer.render(into_the_room(), gathered(48, 36, 32));
  for (size_t k = 0; k < frame.color.pixels.size(); ++k) {
    const float sum =
        frame.emission.pixels[k] +
        frame.albedo.pixels[k] / kPi * (frame.direct.pixels[k] + frame.indirect.pixels[k]);
    EXPECT_NEAR(frame.color.pixels[k], sum, 1e-4f * (1 + sum));
    EXPECT_GE(frame.color.pixels[k], 0);
  }
  RenderSettings bare = gathered(48, 36, 32);
  bare.layers = false;
  EXPECT_EQ(renderer.render(into_the_room(), bare).color.pixels, frame.color.pixels);
}

TEST(PixelCorrection, PixelsWithoutPathsAndThoseThatAreFixedStay) {
  const scene::Scene scene = furnace();
  Renderer renderer(scene);
  renderer.make_table({});
  constexpr int kSide = 24;
  const Frame before = renderer.render(in_the_furnace(), gathered(kSide, kSide, 0));
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(renderer.bvh(), in_the_furnace(), kSide, kSide);
  std::vector<PixelKind> kinds(hits.mask.size(), PixelKind::Smooth);
  std::vector<int32_t> paths(kinds.size(), 4);
  for (size_t i = 0; i < kinds.size(); ++i) {
    if (i % 3 == 1) kinds[i] = PixelKind::Fixed;
    if (i % 3 == 2) paths[i] = 0;
  }
  Image bright(kSide, kSide, 3);
  for (float& value : bright.pixels) value = 7;
  Frame after = before;
  correct_pixels(guides_of(hits), kinds, paths,
                 {{{bright, bright, bright}, {bright, bright, bright}}}, &after);
  for (size_t i = 0; i < kinds.size(); ++i) {
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      if (i % 3 == 0) {
        EXPECT_GT(after.direct.pixels[k], 2 * before.direct.pixels[k]);
      } else {
        EXPECT_EQ(after.direct.pixels[k], before.direct.pixels[k]);
        EXPECT_EQ(after.emission.pixels[k], before.emission.pixels[k]);
      }
    }
  }
}

}  // namespace
}  // namespace lte::infer
