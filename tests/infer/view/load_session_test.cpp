#include "infer/view/load_session.h"

#include <gtest/gtest.h>

namespace lte::infer::view {
namespace {

TEST(LiveScenePoints, AreThoseAskedForOrOfTrainingButFewByDefault) {
  EXPECT_EQ(live_scene_points({}, 2048), 2048);
  EXPECT_EQ(live_scene_points({}, 8192), 4096);
  EXPECT_EQ(live_scene_points(0, 8192), 8192);
  EXPECT_EQ(live_scene_points(6000, 8192), 6000);
  EXPECT_EQ(live_scene_points({}, 0), 0) << "no network";
}

}  // namespace
}  // namespace lte::infer::view
