#include "train/example.h"

#include <map>
#include <set>

#include "tests/train/support.h"

namespace lte::train {
namespace {

TrainingScene uneven_scene() {
  TrainingScene scene;
  scene.name = "uneven";
  scene.light_groups = 2;
  for (int i = 0; i < 1000; ++i) {
    scene.position.push_back({static_cast<float>(i), 0, 0});
    scene.normal.push_back({0, 1, 0});
    scene.albedo.push_back({0.5f, 0.5f, 0.5f});
    scene.light.push_back(i < 3 ? 0 : i < 53 ? 1 : -1);
    scene.emission.push_back(i < 3 ? Rgb{100, 100, 100} : i < 53 ? Rgb{2, 4, 6} : Rgb{});
    scene.area.push_back(i < 53 ? 0.01f : 0.1f);
  }
  scene.query_position = {{0, 0, 0}};
  scene.query_normal = {{0, 1, 0}};
  scene.query_albedo = {{1, 1, 1}};
  scene.target = {{1, 1, 1}, {2, 2, 2}};
  return scene;
}

TEST(DrawRows, AreDistinctAscendingAndInRange) {
  Rng rng(1);
  for (const int64_t rows : {1, 2, 7, 100, 8193}) {
    for (const int64_t count : {int64_t{1}, rows / 2 + 1, rows - 1, rows, rows + 5, int64_t{0}}) {
      const std::vector<int64_t> drawn = draw_rows(rows, count, &rng);
      const bool all = count == 0 || count >= rows;
      ASSERT_EQ(static_cast<int64_t>(drawn.size()), all ? rows : count) << rows << ", " << count;
      for (size_t i = 0; i < drawn.size(); ++i) {
        EXPECT_GE(drawn[i], i == 0 ? 0 : drawn[i - 1] + 1);
        EXPECT_LT(drawn[i], rows);
      }
    }
  }
}

TEST(DrawRows, EveryRowIsEquallyLikely) {
  // 7 of 10: runs of one and of two rows, which without the random start would be drawn with
  // probability 1 and 1/2.
  Rng rng(2);
  constexpr int kDraws = 20'000;
  std::vector<int> hits(10, 0);
  for (int draw = 0; draw < kDraws; ++draw) {
    for (const int64_t row : draw_rows(10, 7, &rng)) ++hits[static_cast<size_t>(row)];
  }
  for (const int count : hits) EXPECT_NEAR(count, 0.7 * kDraws, 5 * 65);  // standard deviation 65
}

TEST(DrawSceneRows, KeepsEveryLuminaireAndTheProportions) {
  const TrainingScene scene = uneven_scene();
  Rng rng(3);
  for (int draw = 0; draw < 20; ++draw) {
    std::map<int32_t, int> kept;
    for (const int64_t row : draw_scene_rows(scene, 100, &rng))
      ++kept[scene.light[static_cast<size_t>(row)]];
    EXPECT_EQ(kept[0], 1);  // three in a thousand, of a hundred: still there
    EXPECT_EQ(kept[1], 5);
    EXPECT_EQ(kept[-1], 95);
  }
}

TEST(MakeExample, SubsamplingKeepsAreaAndEmissionScalar) {
  const TrainingScene scene = uneven_scene();
  Rng rng(4);
  const Example whole = make_example(scene, identity_symmetry(2), 0, 0, &rng);
  const Example part = make_example(scene, identity_symmetry(2), 100, 0, &rng);
  EXPECT_EQ(whole.points.area.size(0), 1000);
  EXPECT_EQ(part.points.area.size(0), 101);
  EXPECT_NEAR(part.points.area.sum().item<double>(), whole.points.area.sum().item<double>(), 1e-3);
  EXPECT_NEAR(nn::radiance_scalar(part.points), nn::radiance_scalar(whole.points), 1e-5);
}

TEST(MakeExample, TargetIsTheSumOverTheEmissionOfItsChannel) {
  const TrainingScene scene = uneven_scene();
  Rng rng(5);
  const Example example = make_example(scene, identity_symmetry(2), 0, 0, &rng);
  for (int c = 0; c < 3; ++c) {
    const double mean = (0.03 * 100 + 0.5 * 2 * (c + 1)) / (0.53 + 94.7);  // area-weighted
    EXPECT_NEAR(example.target[0][c].item<double>(), 3 / mean, 1e-3);
  }
}

TEST(MakeExample, ABlackSceneHasATargetOfZero) {
  TrainingScene scene = uneven_scene();
  for (Rgb& emission : scene.emission) emission = {};
  for (Rgb& target : scene.target) target = {};
  Rng rng(6);
  EXPECT_EQ(
      make_example(scene, identity_symmetry(2), 50, 0, &rng).target.abs().max().item<double>(), 0);
}

TEST(SceneStore, DropsTheLeastRecentlyUsed) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 3, 0);
  const auto entries = data::entries_of(data::read_dataset_info(dir.path()), data::Split::Train);
  SceneStore probe(dir.path(), entries, "indirect", 0);
  const size_t one = probe.get(0)->size_bytes();
  SceneStore store(dir.path(), entries, "indirect", 2 * one);
  const auto first = store.get(0);
  store.get(1);
  EXPECT_EQ(store.get(0), first) << "still kept";
  store.get(2);  // drops 1
  EXPECT_EQ(store.get(0), first);
  EXPECT_EQ(store.cached_bytes(), 2 * one);
  EXPECT_EQ(probe.cached_bytes(), one) << "the latest stays whatever the limit";
}

TEST(SceneStore, TotalIsDirectPlusIndirect) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 1, 0);
  const data::SceneSample sample = data::read_scene_sample(data::scene_path(dir.path(), "room0"));
  const TrainingScene total =
      read_training_scene(data::scene_path(dir.path(), "room0"), "room0", "total");
  const TrainingScene indirect =
      read_training_scene(data::scene_path(dir.path(), "room0"), "room0", "indirect");
  for (size_t i = 0; i < sample.direct.size(); ++i) {
    EXPECT_EQ(total.target[i], sample.direct[i] + sample.indirect[i]);
    EXPECT_EQ(indirect.target[i], sample.indirect[i]);
  }
}

}  // namespace
}  // namespace lte::train
