#include "infer/view/load_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/infer/renderer/two_rooms.h"
#include "tests/support/captured_log.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

/// A model that has seen no sky, in a room under one.
TEST(LoadSession, LeavesOutWhatDoesNotReachTheFirstView) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors", {.scene_points = 200, .pruned = true});
  const auto loaded_from = [&](const scene::Camera& camera, std::string* said) {
    test::TwoRooms rooms;
    rooms.scene.cameras = {camera};
    scene::write_glb(folder / "rooms.glb", rooms.scene);
    ViewRequest request;
    request.scene = (folder / "rooms.glb").string();
    request.checkpoint = (folder / "tiny.safetensors").string();
    request.environment = "1,1,1";
    request.integrator = "network";
    LoadedSession loaded;
    *said =
        test::stderr_of(LogLevel::Warning, [&] { loaded = load_session(request, CommandFiles()); });
    return loaded;
  };
  std::string said;
  const LoadedSession inside = loaded_from(test::TwoRooms::inside(), &said);
  EXPECT_EQ(inside.session->state()->culled_lights().size(), 2u);
  EXPECT_TRUE(inside.session->state()->has_network());
  EXPECT_EQ(said, "");
  const LoadedSession outside = loaded_from(test::TwoRooms::outside(), &said);
  EXPECT_FALSE(outside.session->state()->has_network());
  EXPECT_THAT(said, testing::HasSubstr("the model was trained without a sun or sky"));
}

TEST(LoadSession, ByDefaultTracedLightAnswersAndNoModelIsAsked) {
  const test::TempDir folder;
  scene::write_glb(folder / "room.glb", test::furnished_room());
  ViewRequest request;
  request.scene = (folder / "room.glb").string();
  const LoadedSession loaded = load_session(request, CommandFiles());
  EXPECT_EQ(loaded.session->state()->answered_by(), Method::Gather);
  EXPECT_FALSE(loaded.session->state()->has_network());
  EXPECT_EQ(loaded.session->first_report().encodings, 0);
  test::save_tiny_model(folder / "tiny.safetensors", {.scene_points = 120});
  request.checkpoint = (folder / "tiny.safetensors").string();
  request.integrator = "network";
  const LoadedSession by_network = load_session(request, CommandFiles());
  EXPECT_EQ(by_network.session->state()->answered_by(), Method::Network);
  EXPECT_TRUE(by_network.session->state()->has_network());
}

}  // namespace
}  // namespace lte::infer::view
