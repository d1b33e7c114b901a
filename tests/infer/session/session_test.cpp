// A session against renderers of the scene as edited, fresh sessions, closed forms, and the laws of
// light.
#include "infer/session/session.h"

#include <atomic>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/session/dimmable_picture.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "lte/scene/sampler.h"
#include "tests/infer/fixture.h"
#include "tests/support/closed_forms.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using test::furnished_room;
using test::rotation;
using test::translation;

runtime::Network network(nn::LightInput input = nn::LightInput::Traced, bool pruned = false) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors",
                        {.scene_points = 120, .pruned = pruned, .light_input = input});
  return runtime::Network(folder / "tiny.safetensors");
}

scene::Camera camera() { return {"", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70}; }

RenderSettings picture(Output output = Output::Full, Mode mode = Mode::Neural) {
  RenderSettings out;
  out.output = output;
  out.mode = mode;
  out.width = 24;
  out.height = 16;
  out.direct_samples = 2;
  out.spp = 2;
  out.antialias = 0;
  return out;
}

struct Points {
  explicit Points(const scene::Scene& scene) {
    scene::SamplerOptions options;
    options.seed = 7;
    samples = scene::sample_surface(scene, 200, options);
  }
  runtime::QueryPoints queries() const {
    return {samples.position, samples.normal, samples.albedo};
  }
  scene::SurfaceSamples samples;
};

/// The scene as a file would have it.
scene::Scene exported(const SessionState& state) {
  const test::TempDir folder;
  state.write_glb(folder / "scene.glb");
  return scene::load_scene(folder / "scene.glb");
}

Frame rendered(const scene::Scene& scene, const runtime::Network& network,
               const RenderSettings& settings) {
  Renderer renderer(scene);
  if (renderer.needs_network(settings)) renderer.embed(network, {});
  return renderer.render(camera(), settings);
}

double largest_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double out = a.size() == b.size() ? 0 : INFINITY;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (int c = 0; c < 3; ++c) out = std::max(out, std::fabs(double{a[i][c]} - b[i][c]));
  }
  return out;
}

double mean_of(const std::vector<Rgb>& values) {
  double sum = 0;
  for (const Rgb& v : values) sum += (double{v.x} + v.y + v.z) / 3;
  return sum / static_cast<double>(values.size());
}

TEST(Session, BeginsWithThePictureThatARendererGives) {
  const scene::Scene room = furnished_room();
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    const runtime::Network net = network(input);
    const Session session(room, net);
    EXPECT_EQ(session.state()->render(camera(), picture()).color.pixels,
              rendered(room, net, picture()).color.pixels);
    EXPECT_EQ(session.first_report().encodings, 1);
  }
}

TEST(Session, AMovedObjectGivesThePictureOfTheMovedScene) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  const int box = session.state()->find_instance("box#2");
  const Affine place = translation({1.9f, 0.1f, 1.2f}) * rotation({0, 1, 0}, -0.4f);
  const EditReport report = session.apply(MoveInstance{box, place});
  EXPECT_TRUE(report.bvh_rebuilt);
  EXPECT_EQ(report.encodings, 1);
  const scene::Scene moved = exported(*session.state());
  EXPECT_EQ(moved.instances[2].to_world.m, place.m);
  for (const Mode mode : {Mode::Neural, Mode::Reference}) {
    EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, mode)).color.pixels,
              rendered(moved, net, picture(Output::Full, mode)).color.pixels);
  }
}

TEST(Session, AMovedLampTakesItsLightAlong) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  const LuminaireInfo lamp = session.state()->luminaires()[0];
  ASSERT_EQ(lamp.instances.size(), 1u);
  session.apply(MoveInstance{lamp.instances[0], translation({0.5f, -0.3f, 0.4f})});
  const LuminaireInfo moved = session.state()->luminaires()[0];
  EXPECT_NEAR(length(moved.position - lamp.position - Vec3{0.5f, -0.3f, 0.4f}), 0, 1e-5);
  const scene::Scene scene = exported(*session.state());
  EXPECT_EQ(session.state()->render(camera(), picture()).color.pixels,
            rendered(scene, net, picture()).color.pixels);
}

TEST(Session, ANewAlbedoGivesThePictureOfTheRepaintedScene) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  session.apply(SetMaterial{session.state()->find_material("material1"), {0.1f, 0.2f, 0.7f}});
  scene::Scene painted = furnished_room();
  painted.materials[1].base_color = {0.1f, 0.2f, 0.7f};
  EXPECT_EQ(session.state()->render(camera(), picture()).color.pixels,
            rendered(painted, net, picture()).color.pixels);
}

TEST(Session, DirectLightOfADimmedLampIsItsClosedForm) {
  Session session(test::lit_floor(), std::nullopt);
  session.apply(SetLight{0, 0.25, Rgb{0.5f, 1, 0.25f}});
  RenderSettings settings = picture(Output::Direct, Mode::Reference);
  settings.spp = 256;
  settings.metal = Metal::Diffuse;
  const Frame frame = session.state()->render(test::downward_camera(), settings);
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(session.state()->bvh(), test::downward_camera(), 24, 16);
  // The largest component of the radiance is 5.
  const Rgb radiance = Rgb{0.5f, 1, 0.25f} * (0.25f * 5);
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    const double form =
        test::polygon_irradiance(test::lit_floor_light(), hits.position[i], hits.normal[i]);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(frame.direct.pixels[3 * i + static_cast<size_t>(c)], radiance[c] * form,
                  0.08 * radiance[c] * form + 1e-3);
    }
  }
}

/// Light is linear in each luminaire: every gain and colour follows from darkness and full light.
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
  EXPECT_EQ(session.separate().encodings, 2);
  EXPECT_EQ(session.apply(SetLight{1, 0.5, {}}).encodings, 0);
  EXPECT_EQ(session.undo()->encodings, 0) << "the step before has been separated, too";
  EXPECT_FALSE(session.can_undo());
}

TEST(Session, AnswersAreThoseOfAFreshSession) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  const Points points(room);
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    Session session(room, network(input, /*pruned=*/input == nn::LightInput::Traced));
    const auto expect_fresh = [&](const char* what) {
      EXPECT_EQ(session.change_against_fresh(points.queries()).largest, 0) << what;
    };
    session.apply(SetLight{0, 0.5, {}});
    expect_fresh("dimmed");
    session.apply(MoveInstance{1, translation({0.3f, 0, 0.2f})});
    expect_fresh("moved");
    session.apply(SetMaterial{0, {0.3f, 0.6f, 0.2f}});
    expect_fresh("painted");
    session.apply(SetLight{2, 3, Rgb{1, 0.2f, 0.1f}});
    expect_fresh("recoloured");
    const EditReport added = session.apply(AddInstance{3, translation({0.5f, 0, 1})});
    expect_fresh("another lamp");
    session.apply(RemoveLight{1});
    expect_fresh("one lamp less");
    session.apply(RemoveInstance{added.added_instances.at(0)});
    expect_fresh("the other gone again");
    scene::Environment sky;
    sky.radiance = {0.2f, 0.3f, 0.4f};
    session.apply(SetEnvironment{sky});
    expect_fresh("a sky");
    while (session.undo()) {
    }
    expect_fresh("undone");
  }
}

TEST(Session, UndoAndRedoBringBackEveryBit) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  std::vector<std::vector<Rgb>> answers = {session.state()->irradiance(points.queries())};
  const std::vector<Edit> edits = {SetLight{0, 0.2, {}}, MoveInstance{1, translation({1, 0, 0})},
                                   RemoveInstance{2}, SetMaterial{0, {0.1f, 0.1f, 0.1f}}};
  for (const Edit& edit : edits) {
    session.apply(edit);
    answers.push_back(session.state()->irradiance(points.queries()));
  }
  for (size_t step = edits.size(); step-- > 0;) {
    ASSERT_TRUE(session.undo());
    EXPECT_EQ(session.state()->irradiance(points.queries()), answers[step]);
  }
  EXPECT_FALSE(session.undo());
  for (size_t step = 1; step <= edits.size(); ++step) {
    ASSERT_TRUE(session.redo());
    EXPECT_EQ(session.state()->irradiance(points.queries()), answers[step]);
  }
  EXPECT_FALSE(session.redo());
}

TEST(Session, MergedEditsAreOneStep) {
  Session session(furnished_room(), std::nullopt);
  session.apply(SetLight{0, 0.9, {}});
  session.apply(SetLight{0, 0.8, {}}, /*merge=*/true);
  session.apply(SetLight{0, 0.7, {}}, /*merge=*/true);
  session.undo();
  EXPECT_EQ(session.state()->luminaires()[0].gain, 1);
  EXPECT_FALSE(session.can_undo());
  session.redo();
  EXPECT_FLOAT_EQ(session.state()->luminaires()[0].gain, 0.7f);
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
  // Both have the base colour of the one material that people know.
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
  EXPECT_EQ(session.change_against_fresh(points.queries()).largest, 0);
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
  EXPECT_EQ(session.state()->render(camera(), picture()).color.pixels,
            rendered(scene, net, picture()).color.pixels);
  session.apply(RemoveLight{id});
  EXPECT_EQ(session.state()->render(camera(), picture()).color.pixels,
            rendered(furnished_room(), net, picture()).color.pixels);
  EXPECT_THROW(session.apply(RemoveLight{id}), Error) << "its number is gone for good";
}

TEST(Session, PathsAnswerForASunThatTheNetworkDoesNotKnow) {
  scene::Scene room = furnished_room();
  test::add_punctual(&room, scene::LightKind::Directional, {5, 5, 5});
  Session session(room, network());
  EXPECT_FALSE(session.state()->has_network());
  EXPECT_GT(session.state()->render(camera(), picture()).traced_pixels, 0);
  session.apply(SetLight{2, 0, {}});
  EXPECT_TRUE(session.state()->has_network()) << "the sun has set";
  EXPECT_EQ(session.state()->render(camera(), picture()).traced_pixels, 0);
}

TEST(Session, RefusesAStepAsAWhole) {
  Session session(furnished_room(), std::nullopt);
  const auto refused = [&](const std::vector<Edit>& edits, const std::string& why) {
    const uint64_t version = session.state()->version();
    try {
      session.apply(edits);
      ADD_FAILURE() << why;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(why));
    }
    EXPECT_EQ(session.state()->version(), version);
    EXPECT_FLOAT_EQ(session.state()->luminaires()[0].gain, 1);
    EXPECT_FALSE(session.can_undo());
  };
  const SetLight fine{0, 0.5, {}};
  Affine flat = translation({0, 0, 0});
  flat.m[1][1] = 0;
  refused({fine, MoveInstance{17, {}}}, "no instance of the number 17");
  refused({fine, MoveInstance{1, flat}}, "singular");
  refused({fine, MoveInstance{1, translation({NAN, 0, 0})}}, "not finite");
  refused({fine, MoveInstance{1, translation({2e9f, 0, 0})}}, "from the origin");
  refused({fine, SetLight{9, 1, {}}}, "no luminaire of the number 9");
  refused({fine, SetLight{0, -1, {}}}, "from 0 to");
  refused({fine, SetLight{0, NAN, {}}}, "from 0 to");
  refused({fine, SetLight{0, {}, Rgb{0, 0, 0}}}, "switches a light off");
  refused({fine, SetMaterial{0, {0.5f, 1.5f, 0}}}, "from 0 to 1");
  refused({fine, SetMaterial{44, {}}}, "no material of the number 44");
  refused({fine, MoveLight{0, Vec3{}, {}}}, "move its instance instead");
  scene::PunctualLight bulb;
  bulb.intensity = {-1, 0, 0};
  refused({fine, AddLight{bulb}}, "intensity");
  std::vector<Edit> all = {fine};
  for (int i = 0; i < 5; ++i) all.push_back(RemoveInstance{i});
  refused(all, "last instance");
}

TEST(Session, NamesLeadToNumbersOrToTheNearestName) {
  const Session session(furnished_room(), std::nullopt);
  const StatePtr state = session.state();
  EXPECT_EQ(state->find_instance("box#2"), 2);
  EXPECT_EQ(state->find_luminaire("light1"), 1);
  try {
    state->find_luminaire("lihgt1");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean \"light"));
  }
}

/// The sum of pictures by luminaire is the picture that all give together, but for the noise of
/// direct light, of which rays leave none here.
TEST(DimmablePicture, SumsWhatLuminairesGiveOneByOne) {
  Session session(furnished_room(), network());
  session.apply(SetLight{0, 0.5, {}});
  for (const Output output : {Output::Gi, Output::Irradiance, Output::Full}) {
    RenderSettings settings = picture(output);
    settings.direct_samples = 1024;
    const DimmablePicture dimmable(session.state(), camera(), settings);
    session.apply(SetLight{0, 0.8, Rgb{1, 0.3f, 0.1f}}, true);
    ASSERT_TRUE(dimmable.fits(*session.state()));
    const Frame sum = dimmable.picture(*session.state());
    const Frame whole = session.state()->render(camera(), settings);
    double difference = 0, mean = 0;
    for (size_t i = 0; i < whole.color.pixels.size(); ++i) {
      difference += std::fabs(double{sum.color.pixels[i]} - whole.color.pixels[i]);
      mean += std::fabs(double{whole.color.pixels[i]});
    }
    EXPECT_LT(difference, (output == Output::Full ? 0.02 : 1e-5) * mean);
    EXPECT_EQ(sum.depth.pixels, whole.depth.pixels);
  }
  const DimmablePicture dimmable(session.state(), camera(), picture(Output::Direct));
  session.apply(SetLight{1, 0.5, {}});
  EXPECT_FALSE(dimmable.fits(*session.state())) << "another luminaire is apart now";
  EXPECT_THROW(dimmable.picture(*session.state()), Error);
  EXPECT_THROW(DimmablePicture(session.state(), camera(), picture(Output::Normal)), Error);
}

/// Each state's picture is its own, whatever edits come meanwhile.
TEST(Session, ReadersNeverSeeHalfAnEdit) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  session.separate();
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0, reads = 0;
  const StatePtr first = session.state();
  const std::vector<Rgb> answers = first->irradiance(points.queries());
  const auto read = [&] {
    while (!done) {
      const StatePtr state = session.state();
      // Every edit gives both lamps the same gain, so the answers are those of the first times it.
      const auto gain = static_cast<float>(state->luminaires()[0].gain);
      std::vector<Rgb> law;
      for (const Rgb& answer : answers) law.push_back(answer * gain);
      if (largest_difference(state->irradiance(points.queries()), law) > 1e-4 * mean_of(answers))
        ++wrong;
      ++reads;
    }
  };
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) readers.emplace_back(read);
  for (int step = 1; step <= 40 || reads < 20; ++step) {
    const double gain = 1 + 0.1 * (step % 7);
    session.apply(std::vector<Edit>{SetLight{0, gain, {}}, SetLight{1, gain, {}}});
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(first->irradiance(points.queries()), answers) << "an old state stays as it was";
}

TEST(Session, RandomEditsDoNotMakeItGrow) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  SessionSettings settings;
  settings.embedding.scene_points = 60;
  settings.undo_steps = 20;
  Session session(room, network(nn::LightInput::Emission), settings);
  session.apply(SetLight{0, 0.9, {}});  // few layers, as each is encoded after every move
  const SessionMemory before = session.memory();
  Rng rng(3, 0);
  const auto uniform = [&] { return static_cast<float>(rng.next_u64() >> 40) * 0x1p-24f; };
  std::vector<int> added_instances, added_lights;
  const auto take = [&](std::vector<int>* from) {
    const int id = from->back();
    from->pop_back();
    return id;
  };
  for (int step = 0; step < 240; ++step) {
    const Affine place = translation({2 * uniform(), 0, 2 * uniform()});
    EditReport report;
    switch (static_cast<int>(10 * uniform())) {
      case 1:
        session.apply(SetMaterial{0, {uniform(), uniform(), uniform()}});
        break;
      case 2:
        session.apply(MoveInstance{1 + static_cast<int>(4 * uniform()), place});
        break;
      case 3:  // a lamp or a box
        if (added_instances.size() > 3) break;
        report = session.apply(AddInstance{uniform() < 0.5f ? 4 : 2, place});
        added_instances.push_back(report.added_instances.at(0));
        break;
      case 4:
        if (added_lights.size() > 3) break;
        report = session.apply(AddLight{room.lights[0]});
        added_lights.push_back(report.added_lights.at(0));
        break;
      case 5:
        if (!added_instances.empty()) session.apply(RemoveInstance{take(&added_instances)});
        if (!added_lights.empty()) session.apply(RemoveLight{take(&added_lights)});
        break;
      case 6:
        if (session.undo()) session.redo();
        break;
      default:
        session.apply(SetLight{0, 2.0 * uniform(), {}});
    }
  }
  while (!added_instances.empty()) session.apply(RemoveInstance{take(&added_instances)});
  while (!added_lights.empty()) session.apply(RemoveLight{take(&added_lights)});
  const SessionMemory after = session.memory();
  EXPECT_EQ(after.scene_bytes, before.scene_bytes);
  EXPECT_LE(after.embedding_bytes, before.embedding_bytes * 6 / 5) << "the points differ";
  EXPECT_EQ(after.states, 1);
  EXPECT_EQ(after.undo_steps, 20);
  EXPECT_EQ(session.state()->luminaires().size(), 3u);
  EXPECT_EQ(session.state()->instances().size(), room.instances.size());
}

}  // namespace
}  // namespace lte::infer
