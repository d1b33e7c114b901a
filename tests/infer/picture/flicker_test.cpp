// Flicker of pictures whose light is known in closed form.
#include "infer/picture/flicker.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

using Light = std::function<Rgb(float x, float y)>;

constexpr int kWidth = 40, kHeight = 30;

/// Looks along −Z from z = 4, at the plane z = 0.
scene::Camera camera(float x) { return {"", {x, 0, 4}, {x, 0, 0}, {0, 1, 0}, 50}; }

/// What the camera sees of the plane, and of a card at z = 2 over x > 0.5 where there is one; the
/// card's light is 100. Rays are met in closed form.
FlickerFrame picture(const scene::Camera& camera, const Light& light, bool card = false) {
  FlickerFrame frame{camera, image::Image(kWidth, kHeight, 3), image::Image(kWidth, kHeight, 1)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 d = camera.direction((static_cast<float>(x) + 0.5f) / kWidth,
                                      (static_cast<float>(y) + 0.5f) / kHeight,
                                      static_cast<float>(kWidth) / kHeight);
      const Vec3 near = camera.origin + d * (2 / -d.z), far = camera.origin + d * (4 / -d.z);
      const bool is_card = card && near.x > 0.5f;
      *frame.depth.at(x, y) = is_card ? 2 : 4;
      frame.light.set_rgb(x, y, is_card ? Rgb{100, 100, 100} : light(far.x, far.y));
    }
  }
  return frame;
}

Rgb constant(float, float) { return {1, 2, 3}; }
Rgb ramp(float x, float y) { return {10 + x, 10 + y, 10 - x + 2 * y}; }

TEST(Flicker, IsNoneWhereEachPointKeepsItsLight) {
  const std::vector<FlickerFrame> frames = {picture(camera(0), ramp), picture(camera(0.37f), ramp),
                                            picture(camera(-0.2f), ramp)};
  const Flicker flicker = measure_flicker(frames);
  EXPECT_LT(flicker.change, 1e-6) << "a linear function is interpolated exactly";
  EXPECT_EQ(flicker.pixels, 2 * kWidth * kHeight);
  EXPECT_GT(flicker.compared, flicker.pixels * 3 / 4);
  EXPECT_LT(flicker.compared, flicker.pixels) << "what leaves the picture is not compared";
}

TEST(Flicker, IsTheChangeOverTheLevel) {
  // 1, 2, 3 becomes 1.1, 2.2, 3.3: changes 0.1, 0.2, 0.3, mean level 2.1.
  const std::vector<FlickerFrame> frames = {picture(camera(0), constant),
                                            picture(camera(0.3f), [](float, float) {
                                              return Rgb{1.1f, 2.2f, 3.3f};
                                            })};
  const Flicker flicker = measure_flicker(frames);
  EXPECT_NEAR(flicker.level, 2.1, 1e-5);
  EXPECT_NEAR(flicker.change, std::sqrt((0.01 + 0.04 + 0.09) / 3) / 2.1, 1e-5);
}

TEST(Flicker, WhatIsHiddenInTheNextFrameIsNotCompared) {
  // Points behind the card, or on it in one frame alone, would change by 98 and more.
  const std::vector<FlickerFrame> frames = {picture(camera(0), constant),
                                            picture(camera(0.1f), constant, true)};
  const Flicker flicker = measure_flicker(frames);
  EXPECT_LT(flicker.change, 1e-6);
  EXPECT_LT(flicker.compared, flicker.pixels * 3 / 4);
  EXPECT_GT(flicker.compared, flicker.pixels / 4);
}

TEST(Flicker, AReferenceTakesAwayWhatMovesInIt) {
  const auto shifted = [](float by) {
    return [by](float x, float y) { return ramp(x, y) + Rgb{by, by, by}; };
  };
  // The light itself grows by 0.5; the pictures are 2 too bright in all frames, then in one alone.
  const std::vector<FlickerFrame> reference = {picture(camera(0), shifted(0)),
                                               picture(camera(0.2f), shifted(0.5f))};
  const std::vector<FlickerFrame> steady = {picture(camera(0), shifted(2)),
                                            picture(camera(0.2f), shifted(2.5f))};
  const std::vector<FlickerFrame> jumpy = {picture(camera(0), shifted(0)),
                                           picture(camera(0.2f), shifted(2.5f))};
  const Flicker kept = measure_flicker(steady, reference);
  EXPECT_NEAR(kept.excess, 0, 1e-6);
  EXPECT_GT(kept.change, 0.03);
  EXPECT_NEAR(kept.reference_change * 10.25, 0.5, 0.02);
  const Flicker jumps = measure_flicker(jumpy, reference);
  EXPECT_NEAR(jumps.excess * 10.25, 2, 0.05);
}

TEST(Flicker, FramesThatDoNotBelongTogetherAreRefused) {
  const FlickerFrame frame = picture(camera(0), constant), other = picture(camera(1), constant);
  const auto error = [](const std::vector<FlickerFrame>& frames,
                        const std::vector<FlickerFrame>& reference) {
    return test::error_of([&] { measure_flicker(frames, reference); });
  };
  EXPECT_THAT(error({frame}, {}), testing::HasSubstr("two frames"));
  EXPECT_THAT(error({frame, other}, {frame}), testing::HasSubstr("one each"));
  EXPECT_THAT(error({frame, other}, {frame, frame}), testing::HasSubstr("another camera"));
  FlickerFrame small = frame;
  small.light = image::Image(2, 2, 3);
  EXPECT_THAT(error({frame, small}, {}), testing::HasSubstr("frame 1: is 2x2"));
}

}  // namespace
}  // namespace lte::infer
