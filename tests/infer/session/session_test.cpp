// A session against renderers of the scene as edited, fresh sessions, and itself after undo.
#include "infer/session/session.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using namespace session_test;
using test::furnished_room;
using test::rotation;
using test::translation;

TEST(Session, BeginsWithThePictureThatARendererGives) {
  const scene::Scene room = furnished_room();
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    const runtime::Network net = network(input);
    const Session session(room, net);
    EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, Method::Path)).color.pixels,
              rendered(room, net, picture(Output::Full, Method::Path)).color.pixels);
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
  const RenderSettings paths = picture(Output::Full, Method::Path);
  EXPECT_EQ(session.state()->render(camera(), paths).color.pixels,
            rendered(moved, net, paths).color.pixels);
}

TEST(Session, ANewAlbedoGivesThePictureOfTheRepaintedScene) {
  const runtime::Network net = network();
  Session session(furnished_room(), net);
  session.apply(SetMaterial{session.state()->find_material("material1"), {0.1f, 0.2f, 0.7f}});
  scene::Scene painted = furnished_room();
  painted.materials[1].base_color = {0.1f, 0.2f, 0.7f};
  EXPECT_EQ(session.state()->render(camera(), picture(Output::Full, Method::Path)).color.pixels,
            rendered(painted, net, picture(Output::Full, Method::Path)).color.pixels);
}

TEST(Session, AnswersAreThoseOfAFreshSession) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  const Points points(room);
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    Session session(room, network(input, /*pruned=*/input == nn::LightInput::Traced,
                                  /*suns=*/true));  // the network is asked under a sky, too
    const auto expect_fresh = [&](const char* what) {
      EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0) << what;
    };
    session.apply(SetLight{0, 0.5, {}});
    expect_fresh("dimmed");
    session.apply(MoveInstance{1, translation({0.3f, 0, 0.2f})});
    expect_fresh("moved");
    session.apply(SetMaterial{0, {0.3f, 0.6f, 0.2f}});
    expect_fresh("painted");
    session.apply(SetLight{2, 3, Rgb{1, 0.2f, 0.1f}});
    expect_fresh("recolored");
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
  const auto embedding_bytes = [&] {
    int64_t sum = 0;
    for (const ScaledLayer& each : session.state()->parts().layers)
      sum += each.layer->embedding->info().bytes;
    return sum;
  };
  const int64_t scene_before = scene_bytes(session.state()->scene()), before = embedding_bytes();
  std::vector<std::weak_ptr<const SessionState>> states;
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
    states.push_back(session.state());
  }
  while (!added_instances.empty()) session.apply(RemoveInstance{take(&added_instances)});
  while (!added_lights.empty()) session.apply(RemoveLight{take(&added_lights)});
  EXPECT_EQ(scene_bytes(session.state()->scene()), scene_before);
  EXPECT_LE(embedding_bytes(), before * 6 / 5) << "the points differ";
  const StatePtr now = session.state();
  for (const auto& state : states)
    EXPECT_TRUE(state.expired() || state.lock() == now) << "a state that nobody reads";
  EXPECT_EQ(session.state()->luminaires().size(), 3u);
  EXPECT_EQ(session.state()->instances().size(), room.instances.size());
  int steps = 0;
  while (session.undo(Accuracy::Kept)) ++steps;
  EXPECT_EQ(steps, settings.undo_steps);
}

}  // namespace
}  // namespace lte::infer
