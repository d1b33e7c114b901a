#include "infer/common/memory.h"

#include <ATen/ops/empty.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/common/assets.h"
#include "infer/common/predictor.h"
#include "infer/common/synthetic_room.h"
#include "infer/eval/baselines.h"
#include "infer/eval/scores.h"
#include "lte/base/process_memory.h"
#include "lte/data/dataset.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Memory, SizesAreReadWithTheirUnits) {
  EXPECT_EQ(parse_memory("500M"), 500);
  EXPECT_EQ(parse_memory("2G"), 2048);
  EXPECT_EQ(parse_memory("1.5g"), 1536);
  EXPECT_EQ(parse_memory("512k"), 0.5);
  EXPECT_EQ(parse_memory("300"), 300);
  EXPECT_EQ(parse_memory("0"), 0);
  for (const char* bad : {"", "M", "2T", "-1G", "2GB", "1 G", "nan", "1e400", "inf"})
    EXPECT_THAT(message_of([&] { parse_memory(bad); }), HasSubstr("--max-memory")) << bad;
  EXPECT_EQ(memory_text(210.4), "210 MiB");
  EXPECT_EQ(memory_text(1536), "1.5 GiB");
}

TEST(Memory, QueriesAreCutToWhatFits) {
  const nn::ModelConfig config;
  EXPECT_EQ(MemoryLimit().query_block(config, 10'000'000, kQueryBlock), kQueryBlock);
  EXPECT_EQ(MemoryLimit(100'000).query_block(config, 10'000'000, kQueryBlock), kQueryBlock);
  const double limit_mb = decode_mb(config, 1'000'000, 20'000) + 1;
  const int64_t block = MemoryLimit(limit_mb).query_block(config, 1'000'000, kQueryBlock);
  EXPECT_GT(block, 15'000);
  EXPECT_LE(decode_mb(config, 1'000'000, block), limit_mb);
  EXPECT_THAT(message_of([&] { MemoryLimit(1).query_block(config, 1'000'000, kQueryBlock); }),
              AllOf(HasSubstr("--max-memory 1 MiB"), HasSubstr("1000000 queries"),
                    HasSubstr("raise the limit")));
}

TEST(Memory, AnEncodingThatCannotFitNamesItsNeedAndHowManyPointsWould) {
  const nn::ModelConfig config;
  const MemoryLimit limit(1024);
  EXPECT_NO_THROW(limit.check_encoding(config, 20'000));
  const std::string message = message_of([&] { limit.check_encoding(config, 10'000'000); });
  EXPECT_THAT(message, AllOf(HasSubstr("10000000 scene points"), HasSubstr("--scene-points"),
                             HasSubstr(memory_text(encode_mb(config, 10'000'000)))));
  int64_t fit = 0;
  ASSERT_EQ(std::sscanf(message.c_str() + message.find("take "), "take %ld", &fit), 1) << message;
  EXPECT_NO_THROW(MemoryLimit(1024).check_encoding(config, fit * 99 / 100));
  EXPECT_THROW(MemoryLimit(1024).check_encoding(config, fit * 11 / 10), Error);
}

TEST(Memory, RunningOutIsSaidInOneLineWithTheNeed) {
  const auto explained = [](const std::function<void()>& body) {
    return message_of([&] {
      explain_out_of_memory("encoding 7 scene points", 210, "take fewer (--scene-points)", body);
    });
  };
  const auto words =
      AllOf(HasSubstr("out of memory while encoding 7 scene points"), HasSubstr("210 MiB"),
            HasSubstr("--scene-points"), testing::Not(HasSubstr("\n")));
  EXPECT_THAT(explained([] { at::empty({int64_t{1} << 45}); }), words);
  EXPECT_THAT(explained([] { throw std::bad_alloc(); }), words);
  EXPECT_EQ(explained([] { throw Error("something else"); }), "something else");
  EXPECT_EQ(explain_out_of_memory("", 0, "", [] { return 3; }), 3);
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

TEST(Memory, APredictorKeepsToItsLimitAndAnswersTheSame) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  Predictor free = Predictor::load(folder / "tiny.safetensors", Device::Cpu);
  Predictor limited = Predictor::load(folder / "tiny.safetensors", Device::Cpu);
  const Room room(400, 150'000);
  free.embed(room.scene());
  const std::vector<Rgb> expected = free.predict(room.asked());
  const double limit_mb = encode_mb(nn::ModelConfig(), 400) + 8;
  reset_peak_rss();
  const double before_mb = current_rss_mb();
  limited.limit_memory(MemoryLimit(limit_mb));
  limited.embed(room.scene());
  EXPECT_EQ(limited.predict(room.asked()), expected);
  EXPECT_LE(peak_rss_mb() - before_mb, limit_mb);
  limited.limit_memory(MemoryLimit(2));
  EXPECT_THROW(limited.embed(room.scene()), Error);
}

TEST(Precision, Bf16KeepsTheShippedModelsErrorWithinAPercent) {
  const std::filesystem::path data = asset_path("data/rooms-test", "--data");
  const std::filesystem::path model = checkpoint_or_shipped("");
  double mse[2] = {0, 0};
  const data::DatasetInfo info = data::read_dataset_info(data);
  const auto entries = data::entries_of(info, data::Split::Test);
  ASSERT_GE(entries.size(), 3u);
  for (const nn::Precision precision : {nn::Precision::Fp32, nn::Precision::Bf16}) {
    Predictor predictor = Predictor::load(model, Device::Cpu, precision);
    for (size_t s = 0; s < 3; ++s) {
      const data::SceneSample sample =
          data::read_scene_sample(data::scene_path(data, entries[s].name));
      const std::vector<Rgb> direct = data::sum_groups(sample.scene_direct, sample.light_groups, 1);
      const std::vector<Rgb> indirect =
          data::sum_groups(sample.scene_indirect, sample.light_groups, 1);
      predictor.embed({sample.scene_position, sample.scene_normal, sample.scene_albedo,
                       sample.scene_emission, sample.scene_area, direct, indirect});
      const std::vector<Rgb> got =
          predictor.predict({sample.query_position, sample.query_normal, sample.query_albedo});
      const std::vector<Rgb> reference = data::sum_groups(sample.indirect, sample.light_groups, 1);
      double sum = 0;
      for (size_t i = 0; i < got.size(); ++i) {
        const Vec3 d = (got[i] - reference[i]) / static_cast<float>(predictor.radiance());
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
