// Light of earlier pictures, found again in others: against the light itself, which is known.
#include "infer/renderer/kept_views.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

constexpr Vec3 kUp{0, 1, 0};
constexpr int kWidth = 64, kHeight = 48;
constexpr KeptKind kKind{true, true, true, 8, 8};

scene::Camera above(float x, float height = 3) {
  return {"above", {x, height, 2}, {x, 0, -1}, kUp, 50};
}

float pixel_size(const scene::Camera& camera) {
  return 2 * std::tan(camera.vfov * kPi / 360) / kHeight;
}

/// Irradiance on the floor, linear over it.
Rgb floor_light(const Vec3& p) { return {10 + p.x, 20 - 2 * p.z, 5 + p.x + p.z}; }

/// What a camera sees of the floor (y = 0) at every `step` pixels, as found by rays.
KeptView floor_view(const scene::Camera& camera, int step = 2, KeptKind kind = kKind) {
  const Projection projection(camera, kWidth, kHeight);
  KeptView view(projection, 0, {step, kWidth}, {step, kHeight}, pixel_size(camera));
  view.kind = kind;
  view.values.assign(1, std::vector<Rgb>(view.size()));
  for (int row = 0; row < view.rows.count(); ++row) {
    for (int column = 0; column < view.columns.count(); ++column) {
      const float x = static_cast<float>(view.columns.at(column)) + 0.5f,
                  y = static_cast<float>(view.rows.at(row)) + 0.5f;
      const Vec3 far = projection.point(x, y, 1);
      const float depth = camera.origin.y / (camera.origin.y - far.y);
      if (!(depth > 0 && depth < 30)) continue;
      const size_t at = static_cast<size_t>(row * view.columns.count() + column);
      view.position[at] = projection.point(x, y, depth);
      view.normal[at] = kUp;
      view.depth[at] = depth;
      view.mask[at] = 1;
      view.values[0][at] = floor_light(view.position[at]);
    }
  }
  return view;
}

/// A point on the floor as a camera with this extent of a point would ask for it.
struct Asked {
  gi::SurfacePoint point;
  float extent;
};
Asked asked(float x, float z, float extent = 0.2f) { return {{{x, 0, z}, kUp, 4}, extent}; }

TEST(KeptViews, GiveBackLightThatIsLinearOverAPlane) {
  KeptViews views;
  views.add(floor_view(above(0)));
  Rng rng(5);
  int found = 0;
  for (int i = 0; i < 500; ++i) {
    const Asked ask = asked(2 * rng.uniform() - 1, -1.5f + 2 * rng.uniform());
    int hint = -1;
    const auto light = views.find(ask.point, ask.extent, kKind, &hint);
    if (!light) continue;
    ++found;
    EXPECT_EQ(hint, 0);
    EXPECT_EQ(light->steps, 1);
    const Rgb wanted = floor_light(ask.point.position), got = light->value(0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 2e-3f) << i;
  }
  EXPECT_GT(found, 450);
}

TEST(KeptViews, KnowNothingOfOtherSurfacesSidesAndPlaces) {
  KeptViews views;
  views.add(floor_view(above(0)));
  int hint = -1;
  const auto finds = [&](const Vec3& position, const Vec3& normal) {
    return views.find({position, normal, 4}, 0.2f, kKind, &hint).has_value();
  };
  EXPECT_TRUE(finds({0, 0, -1}, kUp));
  EXPECT_FALSE(finds({0, 0, -1}, -kUp));
  EXPECT_FALSE(finds({0, 0, -1}, {1, 0, 0}));
  EXPECT_FALSE(finds({0, 0.5f, -1}, kUp)) << "a table hides the floor below it";
  EXPECT_FALSE(finds({0, -0.5f, -1}, kUp));
  EXPECT_FALSE(finds({50, 0, -1}, kUp)) << "beside the picture";
  EXPECT_FALSE(finds({0, 0, 40}, kUp)) << "behind the camera";
}

/// A view from far away would blur; one from near by serves.
TEST(KeptViews, AskNoViewWhosePointsAreMuchWider) {
  const Asked ask = asked(0, -1, 0.1f);
  for (const auto& [height, serves] : {std::pair{1.0f, true}, {3.0f, false}, {9.0f, false}}) {
    KeptViews views;
    views.add(floor_view(above(0, height)));
    int hint = -1;
    EXPECT_EQ(views.find(ask.point, ask.extent, kKind, &hint).has_value(), serves) << height;
  }
}

TEST(KeptViews, RatherTakeWhatRaysHaveFound) {
  KeptViews views;
  views.add(floor_view(above(0)));
  KeptView copied = floor_view(above(0.1f));
  std::fill(copied.steps.begin(), copied.steps.end(), uint8_t{3});
  views.add(copied);
  const Asked ask = asked(0, -1);
  int hint = -1;
  auto light = views.find(ask.point, ask.extent, kKind, &hint);
  ASSERT_TRUE(light);
  EXPECT_EQ(light->steps, 1);
  EXPECT_EQ(hint, 0);
  // Alone it serves too, until it has been passed on too often.
  for (const auto& [steps, serves] :
       {std::pair{3, true}, {kMostKeptSteps - 1, true}, {int{kMostKeptSteps}, false}}) {
    std::fill(copied.steps.begin(), copied.steps.end(), static_cast<uint8_t>(steps));
    KeptViews alone;
    alone.add(copied);
    hint = 7;  // of no view
    light = alone.find(ask.point, ask.extent, kKind, &hint);
    ASSERT_EQ(light.has_value(), serves) << steps;
    if (serves) {
      EXPECT_EQ(light->steps, steps + 1);
    }
  }
}

TEST(KeptViews, ServeWhatIsAlikeAndHasNoMoreRays) {
  const Asked ask = asked(0, -1);
  const auto serves = [&](const KeptKind& kept, const KeptKind& wanted) {
    KeptViews views;
    views.add(floor_view(above(0), 2, kept));
    int hint = -1;
    return views.find(ask.point, ask.extent, wanted, &hint).has_value();
  };
  EXPECT_TRUE(serves(kKind, kKind));
  EXPECT_TRUE(serves({true, true, true, 16, 8}, kKind));
  EXPECT_FALSE(serves({true, true, true, 4, 8}, kKind));
  EXPECT_FALSE(serves({true, true, true, 8, 4}, kKind));
  EXPECT_FALSE(serves({true, true, false, 8, 8}, kKind)) << "two layers are not their sum";
  EXPECT_FALSE(serves({false, true, false, 8, 0}, kKind));
}

TEST(KeptViews, ForgetTheOldestBeyondTheirNumber) {
  const auto size = static_cast<int64_t>(floor_view(above(0)).size());
  KeptViews views(2 * size);
  for (int k = 0; k < 5; ++k) views.add(floor_view(above(20.0f * static_cast<float>(k))));
  EXPECT_EQ(views.views(), 2u);
  EXPECT_EQ(views.points(), 2 * size);
  const auto finds = [&](float x) {
    const Asked ask = asked(x, -1);
    int hint = -1;
    return views.find(ask.point, ask.extent, kKind, &hint).has_value();
  };
  EXPECT_FALSE(finds(0));
  EXPECT_FALSE(finds(40));
  EXPECT_TRUE(finds(60));
  EXPECT_TRUE(finds(80));
  KeptViews one(0);
  one.add(floor_view(above(0)));
  EXPECT_EQ(one.views(), 1u) << "the last view stays";
  EXPECT_THROW(KeptViews(-1), Error);
}

}  // namespace
}  // namespace lte::infer
