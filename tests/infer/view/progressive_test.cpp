#include "infer/view/progressive.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/infer/fixture.h"

namespace lte::infer::view {
namespace {

constexpr PictureSize kSize{32, 24};

const auto kNever = [] { return false; };

TEST(Progressive, GetsBetterUntilItIsDone) {
  const Session session(test::lit_floor(), std::nullopt);
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
  many.direct_samples = 4096;
  many.antialias = 0;
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
