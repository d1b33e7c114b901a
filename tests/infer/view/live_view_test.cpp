// Edits of pages, from message to scene.
#include <fstream>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "infer/view/editor.h"
#include "infer/view/session_scene.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/scene.h"
#include "tests/infer/fixture.h"
#include "tests/infer/view/fake_pages.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

class Edited : public testing::Test {
 protected:
  Edited()
      : session_(test::lit_floor(), std::nullopt),
        scene_(describe_scene(*session_.state())),
        editor_(std::make_unique<Editor>(&session_, &scene_, &pages_, [] {})) {}

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
  SceneDescription scene_;
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
  const std::vector<PageEdit> now = settings_of(*editor_->made().state, scene_);
  EXPECT_EQ(now, settings_of(*Session(test::lit_floor(), std::nullopt).state(), scene_));
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

}  // namespace
}  // namespace lte::infer::view
