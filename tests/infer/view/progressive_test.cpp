#include "infer/view/progressive.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/infer/fixture.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer::view {
namespace {

constexpr PictureSize kSize{32, 24};

const auto kNever = [] { return false; };

TEST(Progressive, GetsBetterUntilItIsDone) {
  SessionSettings gathered;
  gathered.pictures = Method::Gather;
  const Session session(test::lit_floor(), std::nullopt, gathered);
  Progressive picture;
  picture.restart(session.state(), test::downward_camera(), Shown::Direct, kSize);
  int steps = 0;
  for (; !picture.done() && steps < 100; ++steps) picture.step(kNever);
  EXPECT_TRUE(picture.done());
  EXPECT_LE(steps, picture.passes());
  ASSERT_EQ(picture.picture().width, kSize.width);
  // The same by many shadow rays at once.
  RenderSettings many;
  many.output = Output::Direct;
  many.width = kSize.width;
  many.height = kSize.height;
  many.light_samples = 4096;
  many.passes = 1;
  many.edge_rays = 0;
  many.denoise = false;
  const Frame exact = session.state()->render(test::downward_camera(), many);
  double off = 0, sum = 0;
  for (size_t i = 0; i < exact.color.pixels.size(); ++i) {
    off += std::abs(exact.color.pixels[i] - picture.picture().pixels[i]);
    sum += exact.color.pixels[i];
  }
  EXPECT_LT(off / sum, 0.02);
}

TEST(Progressive, AnInterruptedPassHasNotHappened) {
  const Session session(test::lit_floor(), std::nullopt);
  Progressive picture;
  picture.restart(session.state(), test::downward_camera(), Shown::Direct, kSize);
  const auto always = [] { return true; };
  EXPECT_TRUE(picture.step(always));  // a draft is shown whatever comes
  const int pass = picture.pass();
  if (!picture.done()) {
    EXPECT_FALSE(picture.step(always));
    EXPECT_EQ(picture.pass(), pass);
    picture.step(kNever);
    EXPECT_EQ(picture.pass(), pass + 1);
  }
}

TEST(Progressive, AReferenceCountsItsPaths) {
  const Session session(test::lit_floor(), std::nullopt);
  Progressive picture;
  picture.restart(session.state(), test::downward_camera(), Shown::Reference, kSize);
  picture.step(kNever);
  EXPECT_EQ(picture.paths(), 0);
  double last = 0;
  for (int i = 0; i < 4; ++i) {
    picture.step(kNever);
    EXPECT_GT(picture.paths(), last);
    last = picture.paths();
  }
  EXPECT_GT(picture.path_seconds(), 0);
}

TEST(Progressive, ARelitPictureIsAsIfAllPassesHadTheNewGains) {
  Session session(test::lit_floor(), std::nullopt);
  session.separate();
  const auto finish = [](Progressive* picture) {
    for (int i = 0; i < 100 && !picture->done(); ++i) picture->step(kNever);
  };
  Progressive lit, fresh;
  lit.restart(session.state(), test::downward_camera(), Shown::Direct, kSize);
  finish(&lit);
  const int64_t passes = lit.rendered();
  session.apply(SetLight{0, 0.3, Rgb{1, 0.2f, 0.6f}});
  ASSERT_TRUE(lit.relight(session.state()));
  EXPECT_TRUE(lit.done());
  EXPECT_EQ(lit.rendered(), passes);
  fresh.restart(session.state(), test::downward_camera(), Shown::Direct, kSize);
  finish(&fresh);
  for (size_t i = 0; i < lit.picture().pixels.size(); ++i)
    EXPECT_NEAR(lit.picture().pixels[i], fresh.picture().pixels[i],
                1e-5f * fresh.picture().pixels[i]);
  // What else changes begins anew.
  Affine higher = session.state()->instances()[0].to_world;
  higher.m[1][3] += 0.1f;
  session.apply(MoveInstance{0, higher});
  EXPECT_FALSE(lit.relight(session.state()));
  lit.restart(session.state(), test::downward_camera(), Shown::Reference, kSize);
  lit.step(kNever);
  session.apply(SetLight{0, 1, {}});
  EXPECT_FALSE(lit.relight(session.state()));
}

TEST(Progressive, ADraftIsRelitToo) {
  constexpr PictureSize kLarge{480, 360};  // of which a first draft is a third
  Session session(test::lit_floor(), std::nullopt);
  session.separate();
  Progressive picture;
  picture.restart(session.state(), test::downward_camera(), Shown::Direct, kLarge);
  EXPECT_FALSE(picture.relight(session.state())) << "there is nothing yet";
  picture.step(kNever);
  ASSERT_EQ(picture.pass(), 1);
  const image::Image bright = picture.picture();
  ASSERT_LT(bright.width, kLarge.width);
  session.apply(SetLight{0, 0.5, {}});
  ASSERT_TRUE(picture.relight(session.state()));
  EXPECT_EQ(picture.pass(), 1);
  double sum = 0;
  for (size_t i = 0; i < bright.pixels.size(); ++i) {
    ASSERT_EQ(picture.picture().pixels[i], 0.5f * bright.pixels[i]);
    sum += bright.pixels[i];
  }
  EXPECT_GT(sum, 0);
  // The whole picture is of the new gain as well.
  picture.step(kNever);
  EXPECT_EQ(picture.picture().width, kLarge.width);
  const auto mean = [](const image::Image& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
           static_cast<double>(image.pixels.size());
  };
  EXPECT_NEAR(mean(picture.picture()), 0.5 * mean(bright), 0.02 * mean(bright));
}

TEST(Progressive, WhatRestsIsHeldToAccountByPaths) {
  SessionSettings settings;
  settings.pictures = Method::Network;
  settings.cache.max_depth = 20;  // of which two reflections leave much to the network
  Session session(test::furnished_room(), session_test::network(), settings);
  session.separate();
  Progressive picture;
  picture.restart(session.state(), session_test::camera(), Shown::Irradiance, kSize);
  for (int i = 0; i < 100 && !picture.done(); ++i) picture.step(kNever);
  ASSERT_TRUE(picture.check());
  EXPECT_TRUE(picture.check()->off()) << "a network without training";
  // Another gain is checked anew.
  session.apply(SetLight{0, 0.5, {}});
  ASSERT_TRUE(picture.relight(session.state()));
  EXPECT_FALSE(picture.done());
  EXPECT_FALSE(picture.check());
}

SessionSettings gathered() {
  SessionSettings settings;
  settings.pictures = Method::Gather;
  return settings;
}

double error_of(const image::Image& picture, const image::Image& reference) {
  double off = 0, sum = 0;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    off += std::abs(picture.pixels[i] - reference.pixels[i]);
    sum += reference.pixels[i];
  }
  return off / sum;
}

TEST(DimmablePicture, WithoutNoiseItIsDimmedAsBefore) {
  Session session(test::furnished_room(), std::nullopt, gathered());
  session.apply(SetLight{0, 0.5, {}});
  RenderSettings settings = session_test::picture(Output::Full);
  settings.denoise = false;
  settings.light_samples = settings.gather_rays = 4;
  RenderSettings many = settings;
  many.light_samples = many.gather_rays = 1024;
  const image::Image reference = session.state()->render(session_test::camera(), many).color;
  StageSeconds seconds;
  DimmablePicture dimmable(session.state(), Output::Full, 24 * 16);
  for (int pass = 0; pass < 2; ++pass, ++settings.seed)
    dimmable.add(session_test::camera(), settings, /*anew=*/false, &seconds);
  const image::Image noisy = dimmable.color(*session.state());
  dimmable.denoise(image::OidnQuality::Balanced);
  const image::Image clean = dimmable.color(*session.state());
  if (clean.pixels == noisy.pixels) GTEST_SKIP() << "there is no Open Image Denoise";
  EXPECT_LT(error_of(clean, reference), 0.8 * error_of(noisy, reference));
  session.apply(SetLight{0, 0, {}}, true);
  const image::Image without = dimmable.color(*session.state());
  session.apply(SetLight{0, 1, {}}, true);
  const image::Image full = dimmable.color(*session.state());
  for (size_t i = 0; i < full.pixels.size(); ++i)
    EXPECT_NEAR(2 * clean.pixels[i], without.pixels[i] + full.pixels[i], 1e-5f * full.pixels[i]);
  session.apply(SetLight{0, 0.5, {}}, true);
  dimmable.add(session_test::camera(), settings, /*anew=*/false, &seconds);
  const image::Image more = dimmable.color(*session.state());
  EXPECT_GT(error_of(more, reference), error_of(clean, reference)) << "a new mean, with its noise";
}

/// Without any network: from the draft to the mean, and by lamp.
TEST(Progressive, GatheredLightGetsBetterUntilItIsThatOfPaths) {
  Session session(test::furnished_room(), std::nullopt, gathered());
  session.separate();
  RenderSettings paths;
  paths.output = Output::Irradiance;
  paths.method = Method::Path;
  paths.width = kSize.width;
  paths.height = kSize.height;
  paths.passes = 16;
  paths.path_samples = 64;
  paths.denoise = false;
  const image::Image reference = session.state()->render(session_test::camera(), paths).color;
  Progressive picture;
  picture.restart(session.state(), session_test::camera(), Shown::Irradiance, kSize);
  picture.step(kNever);
  EXPECT_EQ(picture.seconds().paths, 0);
  EXPECT_GT(picture.seconds().irradiance, 0);
  const double draft = error_of(picture.picture(), reference);
  for (int i = 0; i < 100 && !picture.done(); ++i) picture.step(kNever);
  const double last = error_of(picture.picture(), reference);
  EXPECT_LT(last, 0.1);
  ASSERT_TRUE(picture.check());
  EXPECT_NEAR(picture.check()->whole.ratio, 1, 0.08);
  EXPECT_FALSE(picture.check()->whole.off);
  EXPECT_LT(last, draft);
  const int64_t passes = picture.rendered();
  session.apply(SetLight{0, 0.5, {}});
  ASSERT_TRUE(picture.relight(session.state()));
  EXPECT_EQ(picture.rendered(), passes);
}

TEST(Progressive, AGatheredPassIsInterrupted) {
  const Session session(test::furnished_room(), std::nullopt, gathered());
  Progressive picture;
  picture.restart(session.state(), session_test::camera(), Shown::Full, {320, 240});
  picture.step(kNever);
  const int pass = picture.pass();
  EXPECT_FALSE(picture.step([] { return true; }));
  EXPECT_EQ(picture.pass(), pass);
}

TEST(Progressive, JitterMovesThePictureByItsShareOfAPixel) {
  const scene::Camera camera = test::outside_camera();
  const float aspect = 32.0f / 24;
  const scene::Camera moved = jittered(camera, kSize, 0.5f, -0.25f);
  const Vec3 expected = camera.direction(0.5f + 0.5f / 32, 0.5f + 0.25f / 24, aspect);
  const Vec3 got = moved.direction(0.5f, 0.5f, aspect);
  EXPECT_NEAR(length(expected - got), 0, 1e-3f);
  EXPECT_EQ(jittered(camera, kSize, 0, 0).target, camera.target);
}

}  // namespace
}  // namespace lte::infer::view
