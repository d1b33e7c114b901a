#include "infer/tool/memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/eval/baselines/baselines.h"
#include "infer/eval/measure/embed_sample.h"
#include "infer/eval/measure/scores.h"
#include "lte/base/process_memory.h"
#include "lte/base/random.h"
#include "lte/cli/assets.h"
#include "lte/data/dataset.h"
#include "lte/data/light_groups.h"
#include "lte/nn/cost.h"
#include "lte/runtime/embedding.h"
#include "tests/infer/fixture.h"
#include "tests/support/message_of.h"

namespace lte::infer {
namespace {

using test::message_of;
using testing::HasSubstr;

TEST(Memory, SizesAreReadWithTheirUnits) {
  EXPECT_EQ(parse_memory("500M"), 500);
  EXPECT_EQ(parse_memory("2G"), 2048);
  EXPECT_EQ(parse_memory("1.5g"), 1536);
  EXPECT_EQ(parse_memory("512k"), 0.5);
  EXPECT_EQ(parse_memory("300"), 300);
  EXPECT_EQ(parse_memory("0"), 0);
  for (const char* bad : {"", "M", "2T", "-1G", "2GB", "1 G", "nan", "1e400", "inf"})
    EXPECT_THAT(message_of([&] { parse_memory(bad); }), HasSubstr("--max-memory")) << bad;
}

/// Random points on the floor of a room, under a lamp.
struct Floor {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, emission;
  std::vector<float> area;

  Floor(int64_t count, uint64_t seed) {
    Rng rng(seed);
    for (int64_t i = 0; i < count; ++i) {
      const bool lamp = i % 20 == 0;
      const float x = rng.uniform(0, 6), z = rng.uniform(0, 4);
      position.push_back({x, lamp ? 2.7f : 0, z});
      normal.push_back({0, lamp ? -1.0f : 1.0f, 0});
      albedo.push_back({0.5f, 0.6f, 0.7f});
      emission.push_back(lamp ? Rgb{15, 15, 15} : Rgb{});
      area.push_back(24 / static_cast<float>(count));
    }
  }
  runtime::ScenePoints points() const { return {position, normal, albedo, emission, area}; }
  runtime::QueryPoints queries() const { return {position, normal, albedo}; }
};

TEST(Memory, AnEmbeddingKeepsToItsLimitAndAnswersTheSame) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  const runtime::Network network(folder / "tiny.safetensors");
  const Floor scene(400, 1), asked(150'000, 2);
  const std::vector<Rgb> expected =
      runtime::SceneEmbedding(network, scene.points()).decode(asked.queries());
  const double limit_mb = encode_mb(nn::ModelConfig(), 400) + 8;
  reset_peak_rss();
  const double before_mb = current_rss_mb();
  const runtime::SceneEmbedding limited(network, scene.points(), {.memory = MemoryLimit(limit_mb)});
  EXPECT_EQ(limited.decode(asked.queries()), expected);
  EXPECT_LE(peak_rss_mb() - before_mb, limit_mb);
  EXPECT_THROW(runtime::SceneEmbedding(network, scene.points(), {.memory = MemoryLimit(2)}),
               runtime::NotEnoughMemory);
}

TEST(Precision, Bf16KeepsTheShippedModelsErrorWithinAPercent) {
  const std::filesystem::path data = asset_path("data/homes-test", "--data");
  const std::filesystem::path model = checkpoint_or_shipped("");
  double mse[2] = {0, 0};
  const data::DatasetInfo info = data::read_dataset_info(data);
  const auto entries = data::entries_of(info, data::Split::Test);
  ASSERT_GE(entries.size(), 3u);
  for (const nn::Precision precision : {nn::Precision::Fp32, nn::Precision::Bf16}) {
    const runtime::Network network(model, {.precision = precision});
    for (size_t s = 0; s < 3; ++s) {
      const data::SceneSample sample =
          data::read_scene_sample(data::scene_path(data, entries[s].name));
      const runtime::SceneEmbedding embedding = embed_sample(sample, network, {});
      const std::vector<Rgb> got =
          embedding.decode({sample.query_position, sample.query_normal, sample.query_albedo});
      const std::vector<Rgb> reference = data::sum_groups(sample.indirect, sample.light_groups, 1);
      double sum = 0;
      for (size_t i = 0; i < got.size(); ++i) {
        const Vec3 d = (got[i] - reference[i]) / static_cast<float>(embedding.mean_emission());
        sum += dot(d, d);
      }
      mse[static_cast<int>(precision)] += sum / static_cast<double>(got.size());
    }
  }
  EXPECT_NEAR(mse[1] / mse[0], 1, 0.01);
  EXPECT_NE(mse[1], mse[0]);
}

}  // namespace
}  // namespace lte::infer
