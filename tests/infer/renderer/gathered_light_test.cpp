// Gathered pictures against closed forms and the path tracer's pictures, and how the table is made
// and kept.
#include "infer/renderer/gathered_light.h"

#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/scene/load.h"
#include "tests/infer/fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

scene::Camera into_the_room() { return {"in", {3.8f, 1.2f, 0.2f}, {0, 1, 0.2f}, {0, 1, 0}, 70}; }

RenderSettings gathered(int width, int height, int rays, int step) {
  RenderSettings out;
  out.output = Output::Gi;
  out.indirect = Indirect::Gather;
  out.gather.rays = rays;
  out.gather.step = step;
  out.width = width;
  out.height = height;
  out.antialias = 0;
  return out;
}

Frame reference(Renderer* renderer, const scene::Camera& camera, RenderSettings settings, int paths,
                uint64_t seed = 77) {
  settings.mode = Mode::Reference;
  settings.spp = paths;
  settings.seed = seed;
  return renderer->render(camera, settings);
}

struct Error2 {
  double bias, rms;  ///< relative to the mean of the reference
};

Error2 error(const image::Image& found, const image::Image& wanted) {
  double sum = 0, difference = 0, squares = 0;
  for (size_t i = 0; i < found.pixels.size(); ++i) {
    const double apart = double{found.pixels[i]} - double{wanted.pixels[i]};
    sum += double{wanted.pixels[i]};
    difference += apart;
    squares += apart * apart;
  }
  const auto count = static_cast<double>(found.pixels.size());
  return {difference / sum, std::sqrt(squares / count) * count / sum};
}

/// In a closed box of radiance 1 and albedo ρ, light of depth d is π ρ^(d−1).
TEST(GatheredLight, FurnaceHasTheClosedForm) {
  constexpr float kAlbedo = 0.6f;
  scene::Scene scene;
  const int wall = test::add_material(&scene, {kAlbedo, kAlbedo, kAlbedo}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  Renderer renderer(scene);
  TableSettings table;
  table.paths = 64;
  renderer.make_table(table);
  const scene::Camera camera{"in", {0.5f, 0, 0}, {-1, 0.1f, 0}, {0, 1, 0}, 90};
  RenderSettings settings = gathered(32, 24, 64, 1);
  settings.output = Output::Irradiance;
  const double expected = double{kPi} * (test::geometric_sum(double{kAlbedo}, 5) - 1);
  for (const Denoise denoise : {Denoise::Off, Denoise::Auto}) {
    settings.denoise = denoise;
    const Frame frame = renderer.render(camera, settings);
    double sum = 0, squares = 0;
    for (const float e : frame.color.pixels) {
      sum += double{e};
      squares += (double{e} / expected - 1) * (double{e} / expected - 1);
    }
    const auto count = static_cast<double>(frame.color.pixels.size());
    EXPECT_NEAR(sum / count, expected, 0.015 * expected);
    // In corners rays go on as paths, which have noise.
    EXPECT_LT(std::sqrt(squares / count), 0.04);
  }
}

TEST(GatheredLight, MatchesThePathTracersPictureOfTheSameDepth) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  TableSettings table;
  table.paths = 64;
  renderer.make_table(table);
  const RenderSettings settings = gathered(64, 48, 128, 1);
  const Frame wanted = reference(&renderer, into_the_room(), settings, 1024);
  const Frame found = renderer.render(into_the_room(), settings);
  const Error2 apart = error(found.indirect, wanted.indirect);
  EXPECT_LT(std::fabs(apart.bias), 0.02);
  EXPECT_LT(apart.rms, 0.09);
  EXPECT_EQ(found.decoded, found.queries);
  EXPECT_EQ(renderer.denoised_by(), "") << "noise stays with Denoise::Off";
  EXPECT_GT(renderer.seconds().gather, 0);
  EXPECT_GT(renderer.seconds().table, 0);
}

TEST(GatheredLight, TheShippedCornellBoxIsWithinTheNoiseOfItsReference) {
  const scene::Scene scene = scene::load_scene(asset_path("scenes/cornell_box.glb", "SCENE"));
  Renderer renderer(scene);
  renderer.make_table({});
  const scene::Camera camera = scene.cameras.front();
  const RenderSettings settings = gathered(64, 48, 64, 1);
  const Frame wanted = reference(&renderer, camera, settings, 1024);
  const Error2 apart = error(renderer.render(camera, settings).color, wanted.color);
  const Error2 noise = error(reference(&renderer, camera, settings, 64).color, wanted.color);
  EXPECT_LT(std::fabs(apart.bias), 0.02);
  EXPECT_LT(apart.rms, noise.rms) << "as many plain paths are noisier";
}

TEST(GatheredLight, FewPixelsStandForAllOnTheirSurfaces) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  const Frame dense = renderer.render(into_the_room(), gathered(96, 72, 256, 1));
  for (const int step : {2, 4}) {
    const Frame sparse = renderer.render(into_the_room(), gathered(96, 72, 256, step));
    EXPECT_LT(sparse.decoded, dense.decoded * 3 / (2 * step * step)) << step;
    const Error2 apart = error(sparse.indirect, dense.indirect);
    EXPECT_LT(std::fabs(apart.bias), 0.01) << step;
    EXPECT_LT(apart.rms, step == 2 ? 0.08 : 0.11) << step;
  }
}

TEST(GatheredLight, NoiseIsTakenAway) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = gathered(96, 72, 4, 1);
  const Frame wanted = reference(&renderer, into_the_room(), settings, 512);
  const Frame noisy = renderer.render(into_the_room(), settings);
  settings.denoise = Denoise::Auto;
  const Frame clean = renderer.render(into_the_room(), settings);
  EXPECT_NE(renderer.denoised_by(), "");
  const double before = error(noisy.indirect, wanted.indirect).rms;
  EXPECT_LT(error(clean.indirect, wanted.indirect).rms, 0.6 * before);
}

/// A table of few and noisy entries is wrong: what is left after correction is the noise of as many
/// paths by themselves.
TEST(GatheredLight, CorrectedByPathsItFallsToTheirNoiseAndHasNoFloor) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  TableSettings table;
  table.entries = 64;
  table.paths = 4;
  renderer.make_table(table);
  RenderSettings settings = gathered(32, 24, 8, 1);
  settings.denoise = Denoise::Auto;
  const Frame wanted = reference(&renderer, into_the_room(), settings, 4096);
  const double alone =
      error(renderer.render(into_the_room(), settings).indirect, wanted.indirect).rms;
  double before = alone;
  for (const int paths : {32, 256, 1024}) {
    settings.correction_paths = paths;
    const double now =
        error(renderer.render(into_the_room(), settings).indirect, wanted.indirect).rms;
    EXPECT_LT(now, before) << paths;
    RenderSettings plain = settings;
    plain.denoise = Denoise::Off;
    const double noise =
        error(reference(&renderer, into_the_room(), plain, paths, 5).indirect, wanted.indirect).rms;
    EXPECT_LT(now, 1.3 * noise) << paths;
    before = now;
  }
  EXPECT_LT(before, 0.3 * alone);
}

TEST(GatheredLight, ManyViewsReadOneTableAndDependOnNothingElse) {
  const scene::Scene scene = test::furnished_room();
  scene::Camera other = into_the_room();
  other.origin.x -= 0.5f;
  const RenderSettings settings = gathered(32, 24, 8, 2);
  Renderer renderer(scene);
  renderer.make_table({});
  const gi::RadiosityTable* table = &renderer.table();
  const double seconds = renderer.seconds().table;
  renderer.render(other, settings);
  const Frame second = renderer.render(into_the_room(), settings);
  EXPECT_EQ(&renderer.table(), table);
  EXPECT_EQ(renderer.seconds().table, seconds);
  Renderer fresh(scene);
  set_num_threads(1);
  fresh.make_table({});
  const Frame first = fresh.render(into_the_room(), settings);
  set_num_threads(0);
  EXPECT_EQ(second.color.pixels, first.color.pixels);
}

/// With and without layers: one picture of all light, or two.
TEST(GatheredLight, DirectLightOnTheGridIsThatOfThePathTracer) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = gathered(96, 72, 64, 2);
  settings.output = Output::Full;
  settings.antialias = 4;
  settings.direct_samples = 64;
  const Frame every = renderer.render(into_the_room(), settings);
  settings.gather.direct = true;
  const Frame sparse = renderer.render(into_the_room(), settings);
  const Error2 apart = error(sparse.direct, every.direct);
  EXPECT_LT(std::fabs(apart.bias), 0.01);
  EXPECT_LT(apart.rms, 0.2);
  settings.layers = false;
  const Frame whole = renderer.render(into_the_room(), settings);
  EXPECT_EQ(whole.direct.width, 0);
  EXPECT_LT(error(whole.color, sparse.color).rms, 1e-5);
  EXPECT_EQ(whole.depth.pixels, sparse.depth.pixels);
  EXPECT_EQ(whole.queries, sparse.queries);
  EXPECT_EQ(whole.edge_pixels, sparse.edge_pixels);
  settings.adaptive_direct = settings.layers = true;
  EXPECT_GT(error(renderer.render(into_the_room(), settings).direct, sparse.direct).rms, 1e-3)
      << "shared out over all pixels";
}

scene::Camera turned_a_little() {
  scene::Camera camera = into_the_room();
  camera.target.z += 0.3f;
  return camera;
}

/// A draft whose pictures share light.
RenderSettings kept_draft() {
  RenderSettings settings = gathered(96, 72, 8, 2);
  settings.output = Output::Full;
  settings.gather.direct = true;
  settings.direct_samples = 8;
  settings.denoise = Denoise::On;
  settings.keep_light = true;
  return settings;
}

TEST(GatheredLight, KeptLightIsTakenWhereAnotherPictureShowsItsSurfaces) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = kept_draft();
  settings.keep_light = false;
  const Frame plain = renderer.render(into_the_room(), settings);
  const Frame fresh = renderer.render(turned_a_little(), settings);
  settings.keep_light = true;
  const Frame first = renderer.render(into_the_room(), settings);
  EXPECT_EQ(first.color.pixels, plain.color.pixels) << "there is nothing to take yet";
  const Frame again = renderer.render(into_the_room(), settings);
  EXPECT_LT(again.decoded, first.decoded / 20);
  EXPECT_LT(error(again.color, first.color).rms, 0.02);
  const Frame turned = renderer.render(turned_a_little(), settings);
  EXPECT_LT(turned.decoded, fresh.decoded / 2);
  // Taken light is softer, most in pictures as small as this, and no less right.
  settings.keep_light = false;
  settings.gather.rays = 256;
  settings.direct_samples = 256;
  const Frame wanted = renderer.render(turned_a_little(), settings);
  EXPECT_LT(error(turned.indirect, wanted.indirect).rms,
            1.4 * error(fresh.indirect, wanted.indirect).rms);
  EXPECT_LT(error(turned.direct, wanted.direct).rms, 1.4 * error(fresh.direct, wanted.direct).rms);
  EXPECT_LT(std::fabs(error(turned.color, wanted.color).bias), 0.01);
}

TEST(GatheredLight, KeptLightIsTheSameForAnyNumberOfThreads) {
  const scene::Scene scene = test::furnished_room();
  const auto second = [&](int threads) {
    set_num_threads(threads);
    Renderer renderer(scene);
    renderer.make_table({});
    renderer.render(into_the_room(), kept_draft());
    Frame frame = renderer.render(turned_a_little(), kept_draft());
    set_num_threads(0);
    return frame;
  };
  EXPECT_EQ(second(1).color.pixels, second(3).color.pixels);
}

/// Layers of their own are not taken for a sum, nor few rays for many.
TEST(GatheredLight, KeptLightOfAnotherKindIsLeft) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = kept_draft();
  const Frame first = renderer.render(into_the_room(), settings);
  settings.layers = false;
  EXPECT_EQ(renderer.render(into_the_room(), settings).decoded, first.decoded);
  settings.gather.rays = 16;
  EXPECT_EQ(renderer.render(into_the_room(), settings).decoded, first.decoded);
  settings.gather.rays = 4;
  EXPECT_LT(renderer.render(into_the_room(), settings).decoded, first.decoded / 20);
}

/// Two strips: no row is lost, moved or of other light at their border.
TEST(GatheredLight, LargePicturesAreMadeInStrips) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  // A tall one: strips of 1,024 rows.
  RenderSettings settings = gathered(2048, 1032, 4, 4);
  settings.output = Output::Full;
  settings.gather.direct = true;
  settings.direct_samples = 16;
  int64_t told = 0;
  settings.done = [&](int64_t pixels) { told += pixels; };
  const Frame tall = renderer.render(into_the_room(), settings);
  EXPECT_EQ(told, int64_t{2048} * 1032);
  ASSERT_GT(int64_t{2048} * 1032, kStripPixels);
  settings.output = Output::Albedo;
  const Frame plain = renderer.render(into_the_room(), settings);
  EXPECT_EQ(tall.albedo.pixels, plain.albedo.pixels);
  EXPECT_EQ(tall.depth.pixels, plain.depth.pixels);
  // Rows to both sides of the border have the same light as far as noise goes.
  const auto row_mean = [&](int first, int last) {
    double sum = 0;
    for (int y = first; y < last; ++y)
      for (int x = 0; x < 2048; ++x) sum += double{tall.direct.rgb(x, y).y};
    return sum / (last - first);
  };
  EXPECT_NEAR(row_mean(1024, 1032) / row_mean(1016, 1024), 1, 0.05);
}

TEST(GatheredLight, WhatWasKeptGoesWithItsTable) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  renderer.make_table({});
  RenderSettings settings = gathered(32, 24, 8, 2);
  settings.keep_light = true;
  const Frame first = renderer.render(into_the_room(), settings);
  EXPECT_LT(renderer.render(into_the_room(), settings).decoded, first.decoded / 2);
  renderer.make_table({});
  const Frame anew = renderer.render(into_the_room(), settings);
  EXPECT_EQ(anew.decoded, first.decoded);
  EXPECT_EQ(anew.color.pixels, first.color.pixels);
}

TEST(GatheredLight, NeedsATableAndForTheNetworksAnEmbedding) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const RenderSettings settings = gathered(8, 8, 4, 1);
  EXPECT_FALSE(renderer.needs(settings).network);
  EXPECT_TRUE(renderer.needs(settings).table);
  EXPECT_THAT([&] { renderer.render(into_the_room(), settings); },
              ThrowsMessage<Error>(HasSubstr("make_table() comes first")));
  TableSettings table;
  table.light = TableLight::Network;
  EXPECT_THAT([&] { renderer.make_table(table); },
              ThrowsMessage<Error>(HasSubstr("needs its embedding")));
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  const runtime::Network network(folder / "tiny.safetensors");
  renderer.embed(network, {});
  renderer.make_table(table);
  EXPECT_GT(renderer.table().size(), 1000);
  EXPECT_NO_THROW(renderer.render(into_the_room(), settings));
}

TEST(GatheredLight, RefusesSettingsOutOfRange) {
  EXPECT_THROW(check_gather_settings({0, 1}), Error);
  EXPECT_THROW(check_gather_settings({1, 3}), Error);
  EXPECT_NO_THROW(check_gather_settings({1, 4}));
}

/// Light of one bounce has no indirect part, and a dark scene none at all.
TEST(GatheredLight, WithoutIndirectLightItIsBlack) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  TableSettings table;
  table.max_depth = 1;
  renderer.make_table(table);
  RenderSettings settings = gathered(8, 8, 4, 1);
  settings.max_depth = 1;
  for (const float value : renderer.render(into_the_room(), settings).color.pixels)
    EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace lte::infer
