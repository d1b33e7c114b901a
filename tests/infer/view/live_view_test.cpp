// Edits of pages, from message to scene.
#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "infer/view/editor.h"
#include "infer/view/session_scene.h"
#include "infer/view/view_loop.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/scene.h"
#include "tests/infer/fixture.h"
#include "tests/infer/renderer/two_rooms.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/infer/view/fake_pages.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

class Edited : public testing::Test {
 protected:
  Edited()
      : session_(test::lit_floor(), std::nullopt),
        editor_(std::make_unique<Editor>(&session_, &pages_, [] {})) {
    editor_->start();
  }

  void gain(int client, int64_t gesture, float value) {
    editor_->post(client, ++number_, MakeEdit{LightSetting{0, value, {1, 1, 1}, {}}, gesture});
    settle();
  }
  template <typename Request>
  void ask(const Request& request) {
    editor_->post(1, ++number_, request);
    settle();
  }
  /// Waits until all that was posted has been done.
  void settle() {
    const auto done = [&] {
      for (const auto& [client, number] : editor_->made().handled) {
        if (number == number_) return true;
      }
      return false;
    };
    while (!done()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  double gain_now() const { return editor_->made().state->luminaires().at(0).gain; }

  test::FakePages pages_;
  Session session_;
  std::unique_ptr<Editor> editor_;
  int64_t number_ = 0;
};

TEST_F(Edited, AGestureIsTakenBackAtOnce) {
  gain(1, 1, 0.9f);
  gain(1, 1, 0.5f);
  gain(1, 2, 0.25f);
  ask(Undo{});
  EXPECT_NEAR(gain_now(), 0.5, 1e-6);
  ask(Undo{});
  EXPECT_NEAR(gain_now(), 1, 1e-6);
  ask(Undo{});  // nothing is left
  EXPECT_NEAR(gain_now(), 1, 1e-6);
  ask(Redo{});
  EXPECT_NEAR(gain_now(), 0.5, 1e-6);
}

TEST_F(Edited, GesturesOfTwoPagesAreTwoSteps) {
  gain(1, 1, 0.9f);
  gain(2, 1, 0.5f);
  ask(Undo{});
  EXPECT_NEAR(gain_now(), 0.9, 1e-6);
}

TEST_F(Edited, ResetTakesAllBackAndCanBeUndone) {
  gain(1, 1, 0.25f);
  ask(MakeEdit{MaterialSetting{0, {0.1f, 0.2f, 0.3f}}, 2});
  ask(MakeEdit{ObjectSetting{0, {{0, -1, 0}, 0, 1}}, 3});
  ask(Reset{});
  EXPECT_NEAR(gain_now(), 1, 1e-6);
  const auto settings = [&](const SessionState& state) {
    return settings_of(state, *editor_->made().scene);
  };
  EXPECT_EQ(settings(*editor_->made().state),
            settings(*Session(test::lit_floor(), std::nullopt).state()));
  ask(Undo{});
  EXPECT_NEAR(gain_now(), 0.25, 1e-6);
}

TEST_F(Edited, TheSceneIsSavedAsEdited) {
  gain(1, 1, 0.5f);
  ask(MakeEdit{ObjectSetting{0, {{0, -1, 0}, 0, 1}}, 2});
  ask(Save{SaveFormat::Glb});
  const std::string file = pages_.wait_for_file();
  ASSERT_FALSE(file.empty());
  EXPECT_EQ(test::frame_header(file).at("name"), "lit_floor_edited.glb");
  const test::TempDir folder;
  std::ofstream(folder / "edited.glb", std::ios::binary) << test::frame_bytes(file);
  const scene::Scene back = load_scene(folder / "edited.glb", {});
  EXPECT_NEAR(back.bounds().low.y, -1, 1e-6);
  float brightest = 0;
  for (const scene::Material& material : back.materials)
    brightest = std::max(brightest, max_component(material.emission));
  EXPECT_NEAR(brightest, 0.5f * max_component(test::kLitFloorRadiance), 1e-5f);
}

TEST_F(Edited, AnObjectIsCopiedRemovedAndBroughtBack) {
  const auto objects = [&] { return editor_->made().scene->objects; };
  ASSERT_EQ(objects().size(), 2u);
  ask(CopyObject{0, {0, 1, 0}});
  ASSERT_EQ(objects().size(), 3u);
  const ObjectDescription copy = objects().back();
  EXPECT_EQ(pages_.wait_for_text("added").at("object"), copy.id);
  EXPECT_EQ(copy.name, objects().front().name + "#2");
  EXPECT_NEAR(copy.bounds.low.y, objects().front().bounds.low.y + 1, 1e-6);
  // Its number is its own: what comes and goes beside it changes none.
  ask(MakeEdit{ObjectSetting{copy.id, {{0, 1, 0}, 0, 1}}, 1});
  EXPECT_NEAR(editor_->made().state->instances().back().bounds.low.y, 2, 1e-6);
  ask(RemoveObject{0});
  ASSERT_EQ(objects().size(), 2u);
  EXPECT_EQ(objects().back().id, copy.id);
  EXPECT_EQ(objects().back().bounds.low.y, copy.bounds.low.y) << "where it was added";
  ask(Undo{});
  EXPECT_EQ(objects().size(), 3u);
  ask(Reset{});
  EXPECT_EQ(objects().size(), 2u);
  ask(Undo{});
  EXPECT_EQ(objects().back().id, copy.id);
}

TEST_F(Edited, ALampThatIsAddedLightsWhatIsUnderIt) {
  ask(AddLamp{scene::LightKind::Point, {0, 1, 0}, {0, -1, 0}, Rgb{3, 2, 1}});
  const int lamp = pages_.wait_for_text("added").at("light");
  const SessionState& state = *editor_->made().state;
  ASSERT_EQ(state.scene().lights.size(), 1u);
  EXPECT_EQ(state.scene().lights[0].intensity, (Rgb{3, 2, 1}));
  EXPECT_EQ(editor_->made().scene->lights.back().id, lamp);
  EXPECT_EQ(editor_->made().scene->lights.back().sort, "point");
  ask(MakeEdit{LightSetting{lamp, 0.5f, {1, 1, 1}, Vec3{1, 2, 1}}, 1});
  EXPECT_EQ(editor_->made().state->scene().lights[0].position, (Vec3{1, 2, 1}));
  ask(RemoveLamp{lamp});
  EXPECT_TRUE(editor_->made().state->scene().lights.empty());
  ask(RemoveLamp{lamp});
  EXPECT_NE(pages_.wait_for_text("error"), nullptr);
  // As strong as the scene's own lamp, a square metre that sends out π times its radiance.
  ask(AddLamp{scene::LightKind::Spot, {0, 1, 0}, {1, 0, 0}, {}});
  const scene::PunctualLight& spot = editor_->made().state->scene().lights.at(0);
  EXPECT_NEAR(spot.intensity.x, luminance(test::kLitFloorRadiance) / 4, 1e-4);
  EXPECT_EQ(spot.intensity.x, spot.intensity.z);
  EXPECT_EQ(spot.direction, (Vec3{1, 0, 0}));
  // Where no lamp shines, ten watts for each square metre of the floor, of 16.
  ask(RemoveLamp{editor_->made().scene->lights.back().id});
  gain(1, 5, 0);
  ask(AddLamp{scene::LightKind::Point, {0, 1, 0}, {0, -1, 0}, {}});
  EXPECT_NEAR(editor_->made().state->scene().lights.at(0).intensity.x, 160 / (4 * kPi), 1e-3);
}

TEST_F(Edited, WhatCannotComeBackIsForgotten) {
  for (int i = 0; i < 3; ++i) {
    ask(CopyObject{0, {0, 1, 0}});
    const int copy = editor_->made().scene->objects.back().id;
    ask(Undo{});
    EXPECT_TRUE(session_.remembers(copy)) << "redo brings it back";
    gain(1, i + 1, 0.5f);
    EXPECT_FALSE(session_.remembers(copy)) << "nothing does any more";
  }
  EXPECT_EQ(editor_->made().scene->objects.size(), 2u);
}

/// With a network: what is shown at once is refined until it is the light of a fresh session, and
/// lamps that rest are dimmed without encoding.
TEST(EditedByNetwork, TheLightOfAMoveFollows) {
  test::FakePages pages;
  const scene::Scene room = test::furnished_room();
  const session_test::Points points(room);
  SessionSettings settings;
  settings.pictures = Method::Network;
  Session session(room, session_test::network(), settings);
  std::unique_ptr<ViewLoop> loop;
  Editor editor(&session, &pages, [&] { loop->wake(); });
  ViewState first;
  first.camera = session_test::camera();
  first.size = {24, 16};
  loop = std::make_unique<ViewLoop>([&] { return editor.made(); }, &pages, first);
  editor.start();
  editor.post(1, 5, MakeEdit{ObjectSetting{1, {{0.5f, 0, 0}, 0, 1}}, 1});
  const std::string full = pages.wait_for_picture([](const nlohmann::json& header) {
    return header.at("handled").contains("1") && header.at("done") == true;
  });
  ASSERT_FALSE(full.empty());
  EXPECT_EQ(test::frame_header(full).at("light"), "full");
  EXPECT_EQ(session_test::change_against_fresh(session, points.queries()).largest, 0);
  const auto all_apart = [&] {
    const auto lights = editor.made().state->luminaires();
    return std::all_of(lights.begin(), lights.end(),
                       [](const auto& light) { return light.touched; });
  };
  for (int i = 0; i < 60'000 && !all_apart(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(all_apart());
  EXPECT_EQ(session.apply(SetLight{0, 0.5, {}}).encodings, 0);
  editor.stop();
}

/// Of a room under a sky.
TEST(EditedByNetwork, WhatTheCameraSeesDecidesWhichLightIsLeftOut) {
  test::FakePages pages;
  const test::TwoRooms rooms;
  Session session(rooms.scene,
                  session_test::network(nn::LightInput::Traced, /*pruned=*/true, /*suns=*/true));
  std::unique_ptr<ViewLoop> loop;
  Editor editor(&session, &pages, [&] { loop->wake(); });
  ViewState first;
  first.camera = test::TwoRooms::inside();
  first.size = {24, 16};
  loop = std::make_unique<ViewLoop>([&] { return editor.made(); }, &pages, first,
                                    [&](const auto& camera) { editor.look_from(camera); });
  editor.start();
  const auto comes_to = [&](const std::vector<int>& culled) {
    for (int i = 0; i < 60'000; ++i) {
      const Editor::Made made = editor.made();
      if (made.settled && made.state->culled_lights() == culled) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  };
  EXPECT_TRUE(comes_to({rooms.other_lamp, rooms.sky}));
  MoveCamera out;
  out.camera = test::TwoRooms::outside();
  loop->post(1, 1, out);
  EXPECT_TRUE(comes_to({rooms.lamp, rooms.other_lamp}));
  EXPECT_EQ(editor.made().state->accuracy(), Accuracy::Full);
  editor.stop();
}

}  // namespace
}  // namespace lte::infer::view
