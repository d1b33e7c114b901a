// Points, maps and painted surfaces, against what the scene's shape says.
#include "infer/renderer/attention_map.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/infer/session/session_fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using session_test::camera;
using session_test::network;

TEST(SurfaceNear, IsTheFootOnTheNearestSurface) {
  const scene::Scene scene = test::lit_floor();
  for (const float height : {0.3f, -0.3f, 0.0f}) {
    const auto found = surface_near(scene, {0.7f, height, -0.4f}, 0.5f);
    ASSERT_TRUE(found.has_value()) << height;
    EXPECT_NEAR(length(found->position - Vec3{0.7f, 0, -0.4f}), 0, 1e-5) << height;
    EXPECT_NEAR(found->normal.y, height < 0 ? -1 : 1, 1e-6);
    EXPECT_NEAR(found->albedo.x, 0.5, 1e-6);
  }
  EXPECT_FALSE(surface_near(scene, {0.7f, 0.9f, 0}, 0.5f).has_value());
  const SurfacePoint point = *surface_near(scene, {0, 0.1f, 0}, 1);
  EXPECT_EQ(point.facing({3, 2, 1}).normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(point.facing({3, -2, 1}).normal, (Vec3{0, -1, 0}));
}

/// A furnished room with a record.
struct Room {
  Room() : scene(test::furnished_room()), renderer(scene) {
    EmbedSettings settings;
    settings.record_attention = true;
    renderer.embed(network(), settings);
  }
  SurfacePoint floor_point() const {
    return surface_near(scene, {2, 0, 1.2f}, 0.1f)->facing({2, 1, 1.2f});
  }

  scene::Scene scene;
  Renderer renderer;
};

TEST(AttentionMap, OfTheDecoderIsAMeanOverItsLayers) {
  const Room room;
  const runtime::SceneAttention inside(room.renderer.shared_embedding());
  const AttentionMap all = attention_map(inside, room.floor_point(), {});
  std::vector<double> mean(all.values.size(), 0);
  const auto layers = static_cast<double>(inside.decoder_layers());
  for (size_t layer = 0; layer < inside.decoder_layers(); ++layer) {
    AttentionChoice choice;
    choice.block = concat("decoder.", layer);
    const AttentionMap one = attention_map(inside, room.floor_point(), choice);
    for (size_t i = 0; i < mean.size(); ++i) mean[i] += double{one.values[i]} / layers;
  }
  for (size_t i = 0; i < mean.size(); ++i) EXPECT_NEAR(all.values[i], mean[i], 1e-4);
  // Even shares are 1 among those that are read, of which there are as many as the sum says.
  const double sum = std::accumulate(all.values.begin(), all.values.end(), 0.0);
  const auto read =
      std::count_if(all.values.begin(), all.values.end(), [](float v) { return v > 0; });
  EXPECT_NEAR(sum, static_cast<double>(read), 1e-3);
  EXPECT_EQ(all.most, *std::max_element(all.values.begin(), all.values.end()));
}

TEST(AttentionMap, ABlockOrHeadThatIsNotThereIsNamed) {
  const Room room;
  const runtime::SceneAttention inside(room.renderer.shared_embedding());
  const auto error = [&](const std::string& block, int64_t head) {
    return test::error_of([&] { attention_map(inside, room.floor_point(), {block, head}); });
  };
  EXPECT_THAT(error("decoder.99", -1), testing::HasSubstr("no block \"decoder.99\""));
  EXPECT_THAT(error("decoder.1x", -1), testing::HasSubstr("no block \"decoder.1x\""));
  EXPECT_THAT(error("decoder.", -1), testing::HasSubstr("no block \"decoder.\""));
  EXPECT_THAT(error("up7.0", -1), testing::HasSubstr("down0.0, "));
  EXPECT_THAT(error("decoder", 0), testing::HasSubstr("the decoder has none"));
  EXPECT_THAT(error("down0.0", 99), testing::HasSubstr("head 99: block down0.0 has"));
}

}  // namespace
}  // namespace lte::infer
