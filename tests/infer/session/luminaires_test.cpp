// Luminaires of a live scene: dimmed, recolored, moved, added, by closed forms and linearity.
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "infer/session/dimmable_picture.h"
#include "lte/base/check.h"
#include "lte/pathtrace/gbuffer.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using namespace session_test;
using test::furnished_room;
using test::translation;

TEST(Session, AMovedLampTakesItsLightAlong) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  const LuminaireInfo lamp = session.state()->luminaires()[0];
  ASSERT_EQ(lamp.instances.size(), 1u);
  session.apply(MoveInstance{lamp.instances[0], translation({0.5f, -0.3f, 0.4f})});
  const LuminaireInfo moved = session.state()->luminaires()[0];
  EXPECT_NEAR(length(moved.position - lamp.position - Vec3{0.5f, -0.3f, 0.4f}), 0, 1e-5);
  const scene::Scene scene = exported(*session.state());
  EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, Method::Path)).color.pixels,
            rendered(scene, net, picture(Output::Full, Method::Path)).color.pixels);
}

TEST(Session, DirectLightOfADimmedLampIsItsClosedForm) {
  SessionSettings gathered;
  gathered.pictures = Method::Gather;
  Session session(test::lit_floor(), std::nullopt, gathered);
  session.apply(SetLight{0, 0.25, Rgb{0.5f, 1, 0.25f}});
  RenderSettings settings = picture(Output::Direct);
  settings.light_samples = 256;
  const Frame frame = session.state()->render(test::downward_camera(), settings);
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(session.state()->bvh(), test::downward_camera(), 24, 16);
  // The largest component of the radiance is 5.
  const Rgb radiance = Rgb{0.5f, 1, 0.25f} * (0.25f * 5);
  double sum = 0, expected = 0;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    const double form =
        test::polygon_irradiance(test::lit_floor_light(), hits.position[i], hits.normal[i]);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(frame.direct.pixels[3 * i + static_cast<size_t>(c)], radiance[c] * form,
                  0.08 * radiance[c] * form + 1e-3);
      sum += frame.direct.pixels[3 * i + static_cast<size_t>(c)];
      expected += radiance[c] * form;
    }
  }
  EXPECT_NEAR(sum, expected, 0.01 * expected);
}

/// Light is linear in each luminaire: every gain and color follows from darkness and full light.
TEST(Session, AnswersAreLinearInGainAndColorByChannel) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  const auto at = [&](double gain, const Rgb& color) {
    session.apply(SetLight{0, gain, color});
    return session.state()->irradiance(points.queries());
  };
  const std::vector<Rgb> dark = at(0, {1, 1, 1}), full = at(1, {1, 1, 1});
  const double scale = mean_of(full);
  ASSERT_GT(largest_difference(dark, full), 0.1 * scale);
  const std::vector<std::pair<double, Rgb>> lights = {{0.5, {1, 1, 1}}, {3, {1, 0.5f, 0.1f}}};
  for (const auto& [gain, color] : lights) {
    std::vector<Rgb> law;
    const Rgb factor = color * static_cast<float>(gain);
    for (size_t i = 0; i < dark.size(); ++i) law.push_back(dark[i] + (full[i] - dark[i]) * factor);
    EXPECT_LT(largest_difference(at(gain, color), law), 1e-5 * (1 + gain) * scale);
  }
}

TEST(Session, DimmingEncodesOnceALuminaireAndNeverAgain) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  Session session(std::move(room), network());
  EXPECT_EQ(session.apply(SetLight{0, 0.5, {}}).encodings, 2) << "the lamp, and the others";
  EXPECT_EQ(session.apply(SetLight{0, 0.3, {}}).encodings, 0);
  EXPECT_EQ(session.apply(SetLight{0, {}, Rgb{1, 0, 0}}).encodings, 0);
  const EditReport other = session.apply(SetLight{1, 2, {}});
  EXPECT_EQ(other.encodings, 2) << "this lamp, and what is left";
  EXPECT_EQ(other.points_drawn, 0);
  EXPECT_FALSE(other.bvh_rebuilt);
  EXPECT_EQ(other.layers, 3);
  EXPECT_EQ(session.apply(SetLight{2, 2, {}}).encodings, 0) << "it was alone already";
}

TEST(Session, SeparatedLampsAreDimmedWithoutEncoding) {
  Session session(furnished_room(), network());
  EXPECT_EQ(session.separate()->encodings, 2);
  EXPECT_EQ(session.apply(SetLight{1, 0.5, {}}).encodings, 0);
  EXPECT_EQ(session.undo()->encodings, 0) << "the step before has been separated, too";
  EXPECT_FALSE(session.can_undo());
}

TEST(Session, LampsThatShareAMeshAreDimmedOneByOne) {
  scene::Scene room = furnished_room();
  scene::Instance twin = room.instances[3];
  twin.to_world = translation({1.2f, 0, 0.5f});
  twin.light_group = static_cast<int>(room.light_groups.size());
  room.light_groups.emplace_back("twin");
  room.instances.push_back(twin);
  Session session(room, network());
  session.apply(SetLight{2, 0, {}});
  const StatePtr state = session.state();
  const scene::Scene& scene = state->scene();
  const auto emission = [&](size_t instance) {
    return scene
        .materials[static_cast<size_t>(
            scene.meshes[static_cast<size_t>(scene.instances[instance].mesh)].material)]
        .emission;
  };
  EXPECT_EQ(emission(3), (Rgb{12, 9, 6}));
  EXPECT_EQ(emission(5), (Rgb{0, 0, 0}));
  EXPECT_EQ(state->materials().size(), room.materials.size());
  // Both have the base color of the one material that people know.
  session.apply(SetMaterial{3, {0.2f, 0.2f, 0.2f}});
  for (const InstanceInfo& info : session.state()->instances()) {
    if (info.material != 3) continue;
    const Pick pick =
        session.state()
            ->pick(
                {"", info.bounds.center() - Vec3{0, 0.3f, 0}, info.bounds.center(), {1, 0, 0}, 40},
                0.5f, 0.5f, 1)
            .value();
    EXPECT_EQ(pick.instance, info.id);
    EXPECT_EQ(pick.albedo, (Rgb{0.2f, 0.2f, 0.2f}));
  }
}

TEST(Session, AColorWithoutRedCanBecomeRed) {
  scene::Scene room = furnished_room();
  room.materials[3].emission = {0, 8, 2};
  const Points points(room);
  Session session(room, network());
  session.apply(SetLight{0, 0.5, Rgb{1, 0, 0}});
  EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
  EXPECT_EQ(session.state()->scene().materials[3].emission, (Rgb{4, 0, 0}));
  EXPECT_EQ(session.apply(SetLight{0, 0.5, Rgb{0, 1, 1}}).encodings, 0);
  EXPECT_EQ(session.state()->scene().materials[3].emission, (Rgb{0, 4, 4}));
}

TEST(Session, LampsComeAndGo) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  scene::PunctualLight bulb;
  bulb.name = "bulb";
  bulb.position = {1, 1, 1};
  bulb.intensity = {1, 2, 3};
  const EditReport added = session.apply(AddLight{bulb});
  ASSERT_EQ(added.added_lights.size(), 1u);
  const int id = added.added_lights[0];
  EXPECT_EQ(session.state()->find_luminaire("bulb"), id);
  session.apply(MoveLight{id, Vec3{3, 1, 1}, {}});
  const scene::Scene scene = exported(*session.state());
  EXPECT_EQ(scene.lights.at(0).position, (Vec3{3, 1, 1}));
  EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, Method::Path)).color.pixels,
            rendered(scene, net, picture(Output::Full, Method::Path)).color.pixels);
  session.apply(RemoveLight{id});
  EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, Method::Path)).color.pixels,
            rendered(furnished_room(), net, picture(Output::Full, Method::Path)).color.pixels);
  EXPECT_THROW(session.apply(RemoveLight{id}), Error) << "its number is gone for good";
}

TEST(Session, TheNetworkDoesNotAnswerForASunThatItDoesNotKnow) {
  scene::Scene room = furnished_room();
  test::add_punctual(&room, scene::LightKind::Directional, {5, 5, 5});
  Session session(room, network());
  EXPECT_FALSE(session.state()->has_network());
  session.apply(SetLight{2, 0, {}});
  EXPECT_TRUE(session.state()->has_network()) << "the sun has set";
}

/// The sum of pictures by luminaire is the picture that all give together, but for the noise of
/// direct light, of which rays leave none here.
TEST(DimmablePicture, SumsWhatLuminairesGiveOneByOne) {
  SessionSettings gathers;
  gathers.pictures = Method::Network;
  Session session(furnished_room(), network(), gathers);
  session.apply(SetLight{0, 0.5, {}});
  for (const Output output : {Output::Gi, Output::Irradiance, Output::Full}) {
    RenderSettings settings = picture(output);
    settings.light_samples = settings.gather_rays = 512;
    StageSeconds seconds;
    DimmablePicture dimmable(session.state(), output, 24 * 16);
    EXPECT_EQ(dimmable.layers(), 2);
    dimmable.add(camera(), settings, /*anew=*/true, &seconds);
    session.apply(SetLight{0, 0.8, Rgb{1, 0.3f, 0.1f}}, true);
    ASSERT_TRUE(dimmable.fits(*session.state()));
    const image::Image sum = dimmable.color(*session.state());
    const Frame whole = session.state()->render(camera(), settings);
    double difference = 0, mean = 0;
    for (size_t i = 0; i < whole.color.pixels.size(); ++i) {
      difference += std::fabs(double{sum.pixels[i]} - whole.color.pixels[i]);
      mean += std::fabs(double{whole.color.pixels[i]});
    }
    EXPECT_LT(difference, 0.03 * mean);
    EXPECT_EQ(dimmable.depth().pixels, whole.depth.pixels);
  }
  const DimmablePicture dimmable(session.state(), Output::Direct, 24 * 16);
  session.apply(SetLight{1, 0.5, {}});
  EXPECT_FALSE(dimmable.fits(*session.state())) << "another luminaire is apart now";
  EXPECT_THROW(dimmable.color(*session.state()), Error);
}

TEST(DimmablePicture, WhatHasNoLightOrTakesTooMuchMemoryIsOneLayer) {
  Session session(furnished_room(), network());
  session.separate();
  const int64_t many = DimmablePicture::kMaxBytes / 12;
  EXPECT_EQ(DimmablePicture(session.state(), Output::Full, 100).layers(), 2);
  EXPECT_EQ(DimmablePicture(session.state(), Output::Full, many).layers(), 1);
  const DimmablePicture normals(session.state(), Output::Normal, 100);
  EXPECT_EQ(normals.layers(), 1);
  EXPECT_TRUE(normals.fits(*session.state()));
  session.apply(SetLight{0, 0.5, {}});
  EXPECT_FALSE(normals.fits(*session.state()));
}

TEST(DimmablePicture, APictureThatIsEndedHasNotHappened) {
  Session session(furnished_room(), network());
  session.separate();
  RenderSettings settings = picture(Output::Gi);
  StageSeconds seconds;
  DimmablePicture dimmable(session.state(), Output::Gi, 24 * 16);
  dimmable.add(camera(), settings, true, &seconds);
  const std::vector<float> before = dimmable.color(*session.state()).pixels;
  int asked = 0;
  settings.stop = [&] { return ++asked > 1; };
  EXPECT_THROW(dimmable.add(camera(), settings, true, &seconds), PictureStopped);
  EXPECT_EQ(dimmable.pictures(), 1);
  EXPECT_EQ(dimmable.color(*session.state()).pixels, before);
  settings.stop = nullptr;
  dimmable.add(camera(), settings, false, &seconds);  // the same once more: so is the mean
  EXPECT_EQ(dimmable.pictures(), 2);
  const std::vector<float> mean = dimmable.color(*session.state()).pixels;
  for (size_t i = 0; i < mean.size(); ++i) EXPECT_NEAR(mean[i], before[i], 1e-5f * before[i]);
}

TEST(DimmablePicture, APictureThatIsEndedGoesOnWithTheLayersThatItLacks) {
  Session session(furnished_room(), network());
  session.separate();
  RenderSettings settings = picture(Output::Full);
  StageSeconds seconds;
  DimmablePicture at_once(session.state(), Output::Full, 24 * 16);
  at_once.add(camera(), settings, true, &seconds);
  int finished = 0, asked = 0;  // layers; whether to stop after the first of them
  settings.progress = [&](double share) { finished += share >= 1 ? 1 : 0; };
  const auto in_second_layer = [&] { return finished == 1 && ++asked > 1; };
  settings.stop = in_second_layer;
  DimmablePicture ended(session.state(), Output::Full, 24 * 16);
  EXPECT_EQ(ended.layers(), 2);
  EXPECT_THROW(ended.add(camera(), settings, true, &seconds), PictureStopped);
  session.apply(SetLight{0, 0.5, {}});  // meanwhile a luminaire is dimmed
  finished = 0;
  settings.stop = nullptr;
  ended.add(camera(), settings, true, &seconds);
  EXPECT_EQ(finished, 1) << "one layer";
  EXPECT_EQ(ended.color(*session.state()).pixels, at_once.color(*session.state()).pixels);
  // What clear() drops is rendered anew.
  finished = asked = 0;
  settings.stop = in_second_layer;
  EXPECT_THROW(ended.add(camera(), settings, true, &seconds), PictureStopped);
  ended.clear();
  finished = 0;
  settings.stop = nullptr;
  ended.add(camera(), settings, true, &seconds);
  EXPECT_EQ(finished, 2);
}

}  // namespace
}  // namespace lte::infer
