// Looking inside an embedding, against sums over all latents.
#include "experiments/attention/scene_attention.h"

#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/nn/files/model_file.h"
#include "lte/tensor/functions.h"
#include "tests/nn/support.h"
#include "tests/runtime/spans.h"

namespace lte::experiments {
namespace {

using runtime::EncodeOptions;
using runtime::Network;
using runtime::QueryPoints;
using runtime::SceneEmbedding;
using test::span;

/// A box of random points under random weights.
class Inside : public testing::Test {
 protected:
  Inside() : points_(test::box_scene(150, 2)), network_(random_network()) {
    embedding_ = std::make_shared<const SceneEmbedding>(embed(true));
  }

  static Network random_network() {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() /
        ("lte_attention_" + std::to_string(::getpid()) + ".safetensors");
    nn::LightTransportModel model(test::tiny_config());
    test::randomize(*model, 5);
    nn::save_model(path, model, {{"scene_points", "150"}});
    Network network(path);
    std::filesystem::remove(path);
    return network;
  }

  SceneEmbedding embed(bool record) const {
    EncodeOptions options;
    options.record_attention = record;
    return {network_,
            {span<Vec3>(points_.position), span<Vec3>(points_.normal), span<Rgb>(points_.albedo),
             span<Rgb>(points_.emission), span<float>(points_.area)},
            options};
  }

  nn::PointSet points_;
  Network network_;
  std::shared_ptr<const SceneEmbedding> embedding_;
};

TEST_F(Inside, RecordingLeavesAnswersAsTheyAre) {
  const nn::QuerySet q = test::box_queries(25, 6);
  const QueryPoints queries{span<Vec3>(q.position), span<Vec3>(q.normal), span<Rgb>(q.albedo)};
  EXPECT_EQ(embedding_->decode(queries), embed(false).decode(queries));
  test::expect_error([&] { SceneAttention(std::make_shared<const SceneEmbedding>(embed(false))); },
                     {"not recorded"});
}

TEST_F(Inside, LatentsAreScenePointsWithTheirSides) {
  const SceneAttention inside(embedding_);
  const std::span<const Vec3> all = span<Vec3>(points_.position);
  ASSERT_EQ(inside.positions().size(), static_cast<size_t>(embedding_->info().latents));
  for (size_t i = 0; i < inside.positions().size(); ++i) {
    float least = INFINITY;
    for (size_t j = 0; j < all.size(); ++j) {
      if (span<Vec3>(points_.normal)[j] == inside.normals()[i])
        least = std::min(least, length(all[j] - inside.positions()[i]));
    }
    EXPECT_LT(least, 1e-4f) << "latent " << i;
  }
}

TEST_F(Inside, AQueryReadsTheNearestLatentsByRowsThatSumToOne) {
  const SceneAttention inside(embedding_);
  const Vec3 at{1.3f, 0, 2.2f}, up{0, 1, 0};
  const LatentsRead read = inside.read(at, up, {0.5f, 0.4f, 0.3f});
  ASSERT_EQ(read.latent.size(), static_cast<size_t>(network_.config().query_neighbours));
  ASSERT_EQ(read.by_layer.size(), static_cast<size_t>(network_.config().query_layers));
  float farthest = 0;
  for (const int64_t latent : read.latent)
    farthest = std::max(farthest, length(inside.positions()[static_cast<size_t>(latent)] - at));
  size_t nearer = 0;
  for (const Vec3& p : inside.positions()) nearer += length(p - at) < farthest * 0.9999f ? 1 : 0;
  EXPECT_LT(nearer, read.latent.size());
  for (size_t k = 0; k < read.share.size(); ++k) {
    double mean = 0;
    for (const std::vector<float>& layer : read.by_layer) mean += layer[k] / 2.0;
    EXPECT_NEAR(read.share[k], mean, 1e-6);
  }
  EXPECT_NEAR(std::accumulate(read.share.begin(), read.share.end(), 0.0), 1, 1e-5);
}

TEST_F(Inside, AttentionIsAMultipleOfAnEvenShare) {
  const SceneAttention inside(embedding_);
  EXPECT_EQ(inside.blocks().front().name, "down0.0");
  for (size_t b = 0; b < inside.blocks().size(); ++b) {
    const AttentionBlock& block = inside.blocks()[b];
    const double entropy = inside.entropy(b);
    EXPECT_TRUE(entropy > 0 && entropy < 1 + 1e-6) << block.name;
    // A head's mean over the points of full resolution is one; all heads' is their mean.
    std::vector<float> mean(inside.positions().size(), 0);
    for (int64_t h = 0; h < block.heads; ++h) {
      const std::vector<float> head = inside.attention(b, h, 7);
      if (block.points == static_cast<int64_t>(head.size())) {
        EXPECT_NEAR(std::accumulate(head.begin(), head.end(), 0.0) / head.size(), 1, 1e-4);
      }
      for (size_t i = 0; i < mean.size(); ++i) mean[i] += head[i] / static_cast<float>(block.heads);
    }
    const std::vector<float> all = inside.attention(b, SceneAttention::kAllHeads, 7);
    for (size_t i = 0; i < mean.size(); ++i) EXPECT_NEAR(all[i], mean[i], 1e-4);
  }
  test::expect_error([&] { inside.attention(99, 0, 0); }, {"block 99"});
  test::expect_error([&] { inside.attention(0, 99, 0); }, {"head 99", "down0.0 has 2"});
  test::expect_error([&] { inside.attention(0, -2, 0); }, {"head -2"});
  test::expect_error([&] { inside.attention(0, 0, 1000); }, {"latent 1000"});
}

TEST_F(Inside, InterpolationKeepsTheValuesOfLatentsAndConstants) {
  const SceneAttention inside(embedding_);
  std::vector<float> values(inside.positions().size()), even(values.size(), 2.5f);
  std::iota(values.begin(), values.end(), 1.0f);
  const std::vector<float> there = inside.interpolate(values, inside.positions(), inside.normals());
  for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(there[i], values[i], 0.01f);
  const Vec3 between[] = {{1, 0, 2}, {0.5f, 3, 4}}, normal[] = {{0, 1, 0}, {0, -1, 0}};
  for (const float value : inside.interpolate(even, between, normal))
    EXPECT_NEAR(value, 2.5f, 1e-5);
  test::expect_error([&] { inside.interpolate({even.data(), 3}, between, normal); }, {"got 3 for"});
}

TEST_F(Inside, ThePointsLatentFacesAsThePointDoes) {
  const SceneAttention inside(embedding_);
  for (size_t i = 0; i < inside.positions().size(); i += 5)
    EXPECT_EQ(length(inside.positions()[static_cast<size_t>(
                         inside.latent_at(inside.positions()[i], inside.normals()[i]))] -
                     inside.positions()[i]),
              0);
  // At the corner of floor and wall a point of either takes a latent of its own side.
  const Vec3 corner{0, 0, 2.5f};
  for (const Vec3& normal : {Vec3{0, 1, 0}, Vec3{1, 0, 0}}) {
    const auto latent = static_cast<size_t>(inside.latent_at(corner, normal));
    EXPECT_GT(dot(inside.normals()[latent], normal), 0.5f);
  }
}

}  // namespace
}  // namespace lte::experiments
