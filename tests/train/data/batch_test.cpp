#include "train/data/batch.h"

#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "tests/train/support.h"
#include "train/data/run_data.h"

namespace lte::train {
namespace {

void expect_same(const Example& a, const Example& b) {
  EXPECT_EQ(a.scene, b.scene);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_TRUE(at::equal(a.points.position, b.points.position));
  EXPECT_TRUE(at::equal(a.points.emission, b.points.emission));
  EXPECT_TRUE(at::equal(a.queries.position, b.queries.position));
  EXPECT_TRUE(at::equal(a.target, b.target));
}

TEST(EpochOrder, EachEpochVisitsEverySceneOnceInAnOrderOfItsOwn) {
  EpochOrder order(1, 10);
  std::set<std::vector<size_t>> orders;
  for (uint64_t epoch = 0; epoch < 8; ++epoch) {
    std::vector<size_t> visited;
    for (uint64_t i = 0; i < 10; ++i) visited.push_back(order.scene_at(10 * epoch + i));
    EXPECT_EQ(std::set<size_t>(visited.begin(), visited.end()).size(), 10u);
    orders.insert(visited);
  }
  EXPECT_EQ(orders.size(), 8u);
}

TEST(EpochOrder, DependsOnSeedAndPositionAlone) {
  EpochOrder a(1, 50), b(1, 50), other(2, 50);
  int equal = 0;
  a.scene_at(999);
  for (uint64_t i = 0; i < 50; ++i) {
    EXPECT_EQ(a.scene_at(i), b.scene_at(i));
    equal += a.scene_at(i) == other.scene_at(i) ? 1 : 0;
  }
  EXPECT_LT(equal, 10);
}

class BatchLoaderTest : public testing::Test {
 protected:
  void SetUp() override { test::write_dataset(dir_.path(), 3, 2); }
  test::TempDir dir_;
};

TEST_F(BatchLoaderTest, AStepsExamplesDoNotDependOnHowItWasReached) {
  const TrainConfig config = test::tiny_config(dir_.path(), dir_ / "run");
  RunData straight = open_run_data(config), jumped = open_run_data(config);
  BatchLoader a(config, straight.scale, &straight.train), b(config, jumped.scale, &jumped.train);
  for (int64_t step = 0; step < 4; ++step) a.take(step);
  const std::vector<Example> at_four = a.take(4);
  b.take(6);  // prefetches 7, which is not what is asked for next
  const std::vector<Example> again = b.take(4);
  ASSERT_EQ(at_four.size(), 2u);
  ASSERT_EQ(again.size(), 2u);
  for (size_t i = 0; i < 2; ++i) expect_same(at_four[i], again[i]);
}

TEST_F(BatchLoaderTest, AStepsExamplesDoNotDependOnHowManyThreadsMakeThem) {
  TrainConfig config = test::tiny_config(dir_.path(), dir_ / "run");
  config.train.scenes_per_step = 5;
  RunData one = open_run_data(config), more = open_run_data(config);
  BatchLoader a(config, one.scale, &one.train), b(config, more.scale, &more.train, {}, 3);
  const std::vector<Example> right = a.take(0), got = b.take(0);
  ASSERT_EQ(got.size(), 5u);
  for (size_t i = 0; i < 5; ++i) expect_same(got[i], right[i]);
}

TEST_F(BatchLoaderTest, DrawsAsManyPointsAndQueriesAsAskedAfreshEachEpoch) {
  const TrainConfig config =
      test::tiny_config(dir_.path(), dir_ / "run", "augment: {rotate: none, mirror: false}\n");
  RunData data = open_run_data(config);
  BatchLoader loader(config, data.scale, &data.train);
  std::vector<Example> all;
  for (int64_t step = 0; step < 6; ++step) {
    for (Example& example : loader.take(step)) all.push_back(std::move(example));
  }
  for (const Example& example : all) {
    EXPECT_NEAR(static_cast<double>(example.points.position.size(0)), 192, 2);
    EXPECT_EQ(example.target.size(0), 96);
  }
  for (size_t later = 3; later < 6; ++later) {  // the second epoch of three scenes
    if (all[later].scene != all[0].scene) continue;
    EXPECT_FALSE(at::equal(all[later].queries.position, all[0].queries.position));
    EXPECT_FALSE(at::equal(all[later].points.position, all[0].points.position));
  }
}

TEST_F(BatchLoaderTest, PointDropoutDrawsCountsOverItsWholeRange) {
  const TrainConfig config =
      test::tiny_config(dir_.path(), dir_ / "run", "augment: {point_dropout: 4}\n");
  RunData data = open_run_data(config);
  BatchLoader loader(config, data.scale, &data.train);
  std::vector<double> halvings;  // of the 192 points that are asked for
  for (int64_t step = 0; step < 40; ++step) {
    for (const Example& example : loader.take(step))
      halvings.push_back(std::log2(192.0 / static_cast<double>(example.points.position.size(0))));
  }
  for (const double halving : halvings) {
    EXPECT_GE(halving, -0.05);  // each luminaire keeps a point, so counts are not exact
    EXPECT_LE(halving, 2.05);
  }
  const double mean =
      std::accumulate(halvings.begin(), halvings.end(), 0.0) / static_cast<double>(halvings.size());
  EXPECT_NEAR(mean, 1, 0.3) << "log-uniform between none and two, some eighty draws";
}

TEST_F(BatchLoaderTest, AnUnreadableSceneIsNamedByTheStepThatNeedsIt) {
  const TrainConfig config = test::tiny_config(dir_.path(), dir_ / "run");
  RunData data = open_run_data(config);
  std::filesystem::resize_file(data::scene_path(dir_.path(), "room1"), 100);
  BatchLoader loader(config, data.scale, &data.train);
  test::expect_error([&] { loader.take(0), loader.take(1); }, {"room1.safetensors"});
}

TEST_F(BatchLoaderTest, ValidationIsTheSameWhateverTheSeed) {
  TrainConfig config = test::tiny_config(dir_.path(), dir_ / "run");
  RunData data = open_run_data(config);
  const std::vector<Example> a = validation_examples(config, &data.val);
  config.seed = 99;
  const std::vector<Example> b = validation_examples(config, &data.val);
  ASSERT_EQ(a.size(), 2u);
  for (size_t i = 0; i < 2; ++i) expect_same(a[i], b[i]);
  config.train.validation_scenes = 1;
  EXPECT_EQ(validation_examples(config, &data.val).size(), 1u);
}

TEST_F(BatchLoaderTest, MeanTargetIsThatOfTheReference) {
  TrainConfig config = test::tiny_config(dir_.path(), dir_ / "run");
  config.data.scene_points = config.data.queries_per_scene = 0;
  RunData data = open_run_data(config);
  double expected = 0;
  for (int i = 0; i < 3; ++i) {
    const data::SceneSample sample = test::box_sample(static_cast<uint64_t>(i));
    for (int c = 0; c < 3; ++c) {
      double sum = 0, emission = 0;
      for (const Rgb& value : sample.indirect) sum += value[c];
      for (const Rgb& value : sample.scene_emission) emission += value[c];
      // All points have equal areas.
      const double mean_emission = emission / static_cast<double>(sample.scene_points());
      expected += sum / static_cast<double>(sample.query_points()) / mean_emission / 9;
    }
  }
  EXPECT_NEAR(mean_target(config, &data.train), expected, 1e-4 * expected);
}

}  // namespace
}  // namespace lte::train
