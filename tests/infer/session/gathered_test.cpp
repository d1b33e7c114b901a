// Sessions whose pictures are gathered: against renderers with a cache, and themselves after edits.
#include <cmath>

#include <gtest/gtest.h>

#include "infer/session/dimmable_picture.h"
#include "infer/session/session.h"
#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/scene/luminaire_power.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using namespace session_test;
using test::furnished_room;
using test::translation;

SessionSettings gathered(Method by) {
  SessionSettings settings;
  settings.pictures = by;
  settings.cache.paths = 64;  // a session's cache and a renderer's differ by noise
  return settings;
}

RenderSettings gathered_picture(Output output = Output::Full) {
  RenderSettings settings = picture(output);
  settings.gather_rays = settings.light_samples = 8;
  return settings;
}

image::Image by_renderer(const scene::Scene& scene, const runtime::Network* network) {
  Renderer renderer(scene);
  RenderSettings settings = gathered_picture();
  if (network != nullptr) {
    renderer.embed(*network, {});
    settings.method = Method::Network;
  }
  renderer.make_cache(settings.method, gathered(settings.method).cache);
  return renderer.render(camera(), settings).color;
}

double mean_of_picture(const image::Image& image) {
  double sum = 0;
  for (const float value : image.pixels) sum += value;
  return sum / static_cast<double>(image.pixels.size());
}

/// But for the noise of the caches, each of paths of its own.
void expect_same(const image::Image& a, const image::Image& b) {
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  double off = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) off += std::abs(a.pixels[i] - b.pixels[i]);
  const double mean = mean_of_picture(b);
  EXPECT_GT(mean, 0);
  EXPECT_NEAR(mean_of_picture(a), mean, 0.03 * mean);
  EXPECT_LT(off / static_cast<double>(a.pixels.size()), 0.2 * mean);
}

TEST(GatheredSession, ItsPictureIsThatOfARendererWithACache) {
  const runtime::Network net = network();
  for (const Method by : {Method::Gather, Method::Network}) {
    const bool asks = by == Method::Network;
    Session session(furnished_room(), asks ? std::optional(net) : std::nullopt, gathered(by));
    EXPECT_EQ(session.state()->answered_by(), by);
    EXPECT_EQ(session.first_report().encodings, asks ? 1 : 0);
    expect_same(session.state()->render(camera(), gathered_picture()).color,
                by_renderer(furnished_room(), asks ? &net : nullptr));
    session.apply(
        MoveInstance{session.state()->find_instance("box#2"), translation({1.9f, 0.1f, 1.2f})});
    expect_same(session.state()->render(camera(), gathered_picture()).color,
                by_renderer(exported(*session.state()), asks ? &net : nullptr));
  }
}

TEST(GatheredSession, ADimmedLampTracesNothingAndItsLightFollows) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  Session session(room, std::nullopt, gathered(Method::Gather));
  const auto records = session.state()->parts().records;
  const EditReport report = session.apply(SetLight{1, 0.25, {}});
  EXPECT_EQ(report.light_ms, 0);
  EXPECT_EQ(report.accuracy, Accuracy::Full);
  EXPECT_EQ(session.state()->parts().records, records);
  // Sums by lamp are those of the cache of the gains: the noise of a lamp's own rays apart.
  session.separate();
  RenderSettings settings = gathered_picture(Output::Irradiance);
  settings.gather_rays = settings.light_samples = 256;
  DimmablePicture sums(session.state(), Output::Irradiance, 24 * 16);
  ASSERT_EQ(sums.layers(), 3);
  StageSeconds seconds;
  sums.add(camera(), settings, /*anew=*/true, &seconds);
  for (const double gain : {0.25, 2.0, 0.0}) {
    session.apply(SetLight{0, gain, {}});
    ASSERT_TRUE(sums.fits(*session.state()));
    const double whole = mean_of_picture(session.state()->render(camera(), settings).color);
    EXPECT_NEAR(mean_of_picture(sums.color(*session.state())), whole, 0.03 * whole) << gain;
  }
}

TEST(GatheredSession, KeptLightIsThatOfBeforeUntilItIsRefined) {
  Session session(furnished_room(), std::nullopt, gathered(Method::Gather));
  const auto records = session.state()->parts().records;
  const MoveInstance move{session.state()->find_instance("box#2"), translation({1, 0.1f, 1})};
  EXPECT_EQ(session.apply(move, false, Accuracy::Kept).accuracy, Accuracy::Kept);
  EXPECT_EQ(session.state()->parts().records, records);
  // All of it takes no longer than a part.
  const auto refined = session.refine(Accuracy::Coarse);
  ASSERT_TRUE(refined);
  EXPECT_EQ(refined->accuracy, Accuracy::Full);
  EXPECT_GT(refined->light_ms, 0);
  EXPECT_NE(session.state()->parts().records, records);
  expect_same(session.state()->render(camera(), gathered_picture()).color,
              by_renderer(exported(*session.state()), nullptr));
  ASSERT_TRUE(session.undo(Accuracy::Kept));
  session.refine();
  expect_same(session.state()->render(camera(), gathered_picture()).color,
              by_renderer(furnished_room(), nullptr));
}

TEST(GatheredSession, ALampThatIsAddedAndOneThatGoesAreSeenAtOnce) {
  Session session(furnished_room(), std::nullopt, gathered(Method::Gather));
  scene::PunctualLight lamp;
  lamp.position = {2, 1.5f, 1};
  lamp.intensity = {5, 5, 5};
  const EditReport added = session.apply(AddLight{lamp}, false, Accuracy::Kept);
  EXPECT_EQ(session.state()->render(camera(), gathered_picture()).color.width, 24);
  session.refine();
  expect_same(session.state()->render(camera(), gathered_picture()).color,
              by_renderer(exported(*session.state()), nullptr));
  session.apply(RemoveLight{added.added_lights.at(0)}, false, Accuracy::Kept);
  for (const LuminaireInfo& left : session.state()->luminaires())
    session.apply(RemoveLight{left.id}, false, Accuracy::Kept);
  EXPECT_FALSE(session.state()->has_light());
  EXPECT_EQ(session.state()->render(camera(), gathered_picture()).color.width, 24);
}

TEST(GatheredSession, LightThatNoNetworkKnowsIsGathered) {
  scene::Scene room = furnished_room();
  test::add_punctual(&room, scene::LightKind::Directional, {5, 5, 5});
  Session session(room, network(), gathered(Method::Network));
  EXPECT_EQ(session.state()->answered_by(), Method::Gather);
  EXPECT_FALSE(session.state()->has_network());
  expect_same(session.state()->render(camera(), gathered_picture()).color,
              by_renderer(room, nullptr));
}

TEST(LuminairePower, IsThatOfSurfacesPointsAndSpots) {
  scene::Scene floor = test::lit_floor();  // a square of 1 m² under a front of (π, …) W/m²
  test::add_point_light(&floor, {0, 1, 0}, {1, 2, 3});
  test::add_punctual(&floor, scene::LightKind::Directional, {5, 5, 5});
  const std::vector<Rgb> powers = scene::luminaire_powers(floor);
  ASSERT_EQ(powers.size(), 3u);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(powers[0][c], kPi * test::kLitFloorRadiance[c], 1e-4f);
    EXPECT_NEAR(powers[1][c], 4 * kPi * static_cast<float>(c + 1), 1e-4f);
  }
  EXPECT_EQ(powers[2], Rgb());
  const std::vector<Rgb> four = {{9, 9, 9}, {0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
  EXPECT_NEAR(scene::median_power(four), 3, 1e-6);
  EXPECT_EQ(scene::median_power({}), 0);
}

}  // namespace
}  // namespace lte::infer
