// Light that is less accurate for a while: what it keeps, how far it is off, and that refining it
// leads to every bit of a fresh session.
#include <atomic>

#include <gtest/gtest.h>

#include "infer/session/session.h"
#include "lte/scene/load.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using namespace session_test;
using test::furnished_room;
using test::translation;

const Affine kElsewhere = translation({0.3f, 0, 0.2f});

TEST(Accuracy, KeptLightCostsNoEncodingAndIsThatOfBefore) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  const std::vector<Rgb> before = session.state()->irradiance(points.queries());
  const EditReport report = session.apply(MoveInstance{1, kElsewhere}, false, Accuracy::Kept);
  EXPECT_EQ(report.accuracy, Accuracy::Kept);
  EXPECT_EQ(report.encodings, 0);
  EXPECT_EQ(report.points_drawn, 0);
  EXPECT_TRUE(report.bvh_rebuilt);
  EXPECT_EQ(session.state()->irradiance(points.queries()), before);
  // Direct light is that of the scene as edited.
  const scene::Scene moved = exported(*session.state());
  Session fresh(moved, std::nullopt);
  EXPECT_EQ(session.state()->render(camera(), picture(Output::Direct)).color.pixels,
            fresh.state()->render(camera(), picture(Output::Direct)).color.pixels);
}

TEST(Accuracy, RefinedLightIsThatOfAFreshSessionBitByBit) {
  scene::Scene room = furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  const Points points(room);
  for (const bool pruned : {false, true}) {
    Session session(room, network(nn::LightInput::Traced, pruned));
    session.separate();
    const std::vector<std::vector<Edit>> steps = {
        {MoveInstance{1, kElsewhere}},
        {SetLight{0, 0.4, Rgb{1, 0.5f, 0.2f}}, MoveInstance{2, translation({1, 0, 1})}},
        {RemoveLight{1}},
        {AddInstance{3, translation({0.5f, 0, 1})}},
        {SetMaterial{0, {0.3f, 0.6f, 0.2f}}}};
    for (const std::vector<Edit>& step : steps) {
      session.apply(step, false, Accuracy::Kept);
      ASSERT_EQ(session.state()->accuracy(), Accuracy::Kept);
      const std::optional<EditReport> edits = session.refine(Accuracy::Coarse);
      ASSERT_TRUE(edits);
      EXPECT_EQ(edits->accuracy, Accuracy::Coarse);
      EXPECT_EQ(edits->encodings, 1);
      EXPECT_FALSE(session.refine(Accuracy::Coarse)) << "it is so already";
      ASSERT_TRUE(session.refine(Accuracy::Full));
      EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
      EXPECT_FALSE(session.refine(Accuracy::Full));
    }
    while (session.undo(Accuracy::Kept)) {
    }
    session.refine();
    EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
  }
}

TEST(Accuracy, DimmingNeedsNoLessAccurateLight) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  EXPECT_EQ(session.apply(SetLight{0, 0.5, {}}, false, Accuracy::Kept).accuracy, Accuracy::Kept)
      << "it is encoded apart first";
  EXPECT_EQ(session.refine(Accuracy::Coarse)->accuracy, Accuracy::Full) << "the points are there";
  EXPECT_EQ(session.apply(SetLight{0, 0.2, {}}, false, Accuracy::Kept).accuracy, Accuracy::Full);
  EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
  session.apply(MoveInstance{1, kElsewhere}, false, Accuracy::Kept);
  EXPECT_EQ(session.undo(Accuracy::Kept)->accuracy, Accuracy::Full) << "all of it was kept";
}

/// A luminaire with a layer of its own is dimmed in what is kept, too.
TEST(Accuracy, KeptLightIsDimmed) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  session.separate();
  session.apply(std::vector<Edit>{SetLight{0, 0, {}}, SetLight{1, 0.5, {}}});
  const std::vector<Rgb> law = session.state()->irradiance(points.queries());
  session.apply(std::vector<Edit>{SetLight{0, 1, {}}, SetLight{1, 1, {}}});
  session.apply(MoveInstance{1, kElsewhere}, false, Accuracy::Kept);
  session.apply(std::vector<Edit>{SetLight{0, 0, {}}, SetLight{1, 0.5, {}}}, false, Accuracy::Kept);
  EXPECT_EQ(session.state()->accuracy(), Accuracy::Kept);
  EXPECT_EQ(session.state()->irradiance(points.queries()), law);
  session.apply(std::vector<Edit>{RemoveLight{0}, RemoveLight{1}}, false, Accuracy::Kept);
  EXPECT_FALSE(session.state()->has_light());
  session.state()->render(camera(), picture());  // all is dark, and nothing is asked
}

TEST(Accuracy, WhatIsStoppedHasNotHappened) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network(nn::LightInput::Traced, /*pruned=*/true));
  session.apply(MoveInstance{1, kElsewhere}, false, Accuracy::Kept);
  const StatePtr before = session.state();
  // Ends it at each of its looks in turn, until one attempt comes through.
  int attempts = 0;
  for (;; attempts += 7) {
    std::atomic<int> looks = 0;
    if (session.refine(Accuracy::Full, [&] { return looks++ >= attempts; })) break;
    ASSERT_EQ(session.state(), before);
    ASSERT_LT(attempts, 10000);
  }
  EXPECT_GT(attempts, 2) << "points, light and encodings can be ended";
  EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
  EXPECT_FALSE(session.separate({}, [] { return true; }));
  EXPECT_TRUE(session.separate());
}

/// docs/editing.md has these bounds.
TEST(Accuracy, ADraftByTheShippedModelIsNearAFreshSession) {
  constexpr double kMaxRms = 0.5, kMaxChange = 10;
  scene::Scene room = scene::load_scene(LTE_SOURCE_DIR "/assets/scenes/living_room.glb");
  const Points points(room);
  Session session(std::move(room),
                  runtime::Network(LTE_SOURCE_DIR "/assets/models/lte.safetensors"));
  session.separate();
  std::vector<Edit> edits = {SetLight{0, 0.5, {}}};
  for (const InstanceInfo& info : session.state()->instances()) {
    if (!info.name.starts_with("armchair") && !info.name.starts_with("piece 9")) continue;
    edits.push_back(MoveInstance{info.id, translation({0.4f, 0, 0}) * info.to_world});
  }
  ASSERT_GT(edits.size(), 3u) << "an armchair and a lamp";
  session.apply(edits, false, Accuracy::Kept);
  session.refine(Accuracy::Coarse);
  const AnswerChange change = change_against_fresh(session, points.queries());
  EXPECT_GT(change.rms, 0);
  EXPECT_LT(change.rms, kMaxRms);
  EXPECT_LT(change.relative, kMaxChange);
}

TEST(Accuracy, AResetLeadsToTheBeginningAndCanBeUndone) {
  const scene::Scene room = furnished_room();
  const Points points(room);
  Session session(room, network());
  const std::vector<Rgb> first = session.state()->irradiance(points.queries());
  EXPECT_FALSE(session.reset()) << "nothing has been edited";
  const int copy = session.apply(AddInstance{1, kElsewhere}).added_instances.at(0);
  session.apply(RemoveInstance{2});
  ASSERT_TRUE(session.reset());
  EXPECT_EQ(session.state()->irradiance(points.queries()), first);
  EXPECT_TRUE(session.remembers(copy));
  session.undo();
  EXPECT_EQ(session.state()->instances().size(), room.instances.size());
  EXPECT_EQ(session.state()->find_instance("box#3"), copy);
  EXPECT_FALSE(session.remembers(copy + 1));
}

}  // namespace
}  // namespace lte::infer
