#include "infer/tool/memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/eval/measure/embed_sample.h"
#include "infer/eval/measure/scores.h"
#include "infer/eval/rivals/baselines.h"
#include "infer/tool/assets.h"
#include "infer/tool/synthetic_room.h"
#include "lte/base/process_memory.h"
#include "lte/data/dataset.h"
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

/// Scene points and queries of the synthetic room as spans.
struct Room {
  nn::PointSet points, queries;
  Room(int64_t M, int64_t Q) : points(synthetic_room(M, 1)), queries(synthetic_room(Q, 2)) {}

  template <typename T>
  static std::span<const T> span(const at::Tensor& t) {
    return {static_cast<const T*>(t.const_data_ptr()), static_cast<size_t>(t.size(0))};
  }
  ScenePoints scene() const {
    return {span<Vec3>(points.position), span<Vec3>(points.normal), span<Rgb>(points.albedo),
            span<Rgb>(points.emission), span<float>(points.area)};
  }
  QueryPoints asked() const {
    return {span<Vec3>(queries.position), span<Vec3>(queries.normal), span<Rgb>(queries.albedo)};
  }
};

TEST(Memory, AnEmbeddingKeepsToItsLimitAndAnswersTheSame) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  const runtime::Network network(folder / "tiny.safetensors");
  const Room room(400, 150'000);
  const std::vector<Rgb> expected =
      runtime::SceneEmbedding(network, room.scene()).decode(room.asked());
  const double limit_mb = encode_mb(nn::ModelConfig(), 400) + 8;
  reset_peak_rss();
  const double before_mb = current_rss_mb();
  const runtime::SceneEmbedding limited(network, room.scene(), {.memory = MemoryLimit(limit_mb)});
  EXPECT_EQ(limited.decode(room.asked()), expected);
  EXPECT_LE(peak_rss_mb() - before_mb, limit_mb);
  EXPECT_THROW(runtime::SceneEmbedding(network, room.scene(), {.memory = MemoryLimit(2)}),
               runtime::NotEnoughMemory);
}

TEST(Precision, Bf16KeepsTheShippedModelsErrorWithinAPercent) {
  const std::filesystem::path data = asset_path("data/homes-test", "--data");
  const std::filesystem::path model = checkpoint_or_shipped("", kHybridModel);
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
