#include "train/data/example.h"

#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "lte/base/check.h"
#include "lte/radiosity/point_radiosity.h"
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

TEST(MakeExample, SubsamplingKeepsAreaAndEmissionScalar) {
  const TrainingScene scene = uneven_scene();
  Rng rng(4);
  const Example whole = make_example(scene, identity_symmetry(2), 0, 0, &rng);
  const Example part = make_example(scene, identity_symmetry(2), 100, 0, &rng);
  EXPECT_EQ(whole.points.area.size(0), 1000);
  EXPECT_EQ(part.points.area.size(0), 100);
  EXPECT_NEAR(part.points.area.sum().item<double>(), whole.points.area.sum().item<double>(), 1e-3);
  EXPECT_NEAR(nn::mean_emission(part.points), nn::mean_emission(whole.points), 1e-5);
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

TEST(MakeExample, QueriesAreDistinctAndEquallyLikely) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(7);
  sample.name = "room";
  data::write_scene_sample(dir / "room.safetensors", sample);
  const TrainingScene scene = read_training_scene(dir / "room.safetensors", "room");
  constexpr int kDraws = 2000, kQueries = 32;
  std::map<std::array<float, 3>, int> times;
  Rng rng(17);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Example example = make_example(scene, identity_symmetry(2), 64, kQueries, &rng);
    std::set<std::array<float, 3>> drawn;
    for (const Vec3& p : test::triples_of(example.queries.position)) drawn.insert({p.x, p.y, p.z});
    ASSERT_EQ(drawn.size(), size_t{kQueries});
    for (const auto& query : drawn) ++times[query];
  }
  ASSERT_EQ(times.size(), scene.query_position.size());
  const double mean = double{kDraws} * kQueries / static_cast<double>(times.size());
  for (const auto& [query, count] : times) EXPECT_NEAR(count, mean, 5 * std::sqrt(mean));
}

TEST(MakeExample, RadiosityIsSolvedByLightGroup) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(7);
  sample.name = "room";
  data::write_scene_sample(dir / "room.safetensors", sample);
  const TrainingScene scene =
      read_training_scene(dir / "room.safetensors", "room", nn::LightInput::Radiosity);
  Symmetry symmetry = identity_symmetry(2);
  symmetry.gains = {{2, 1, 0}, {0, 0.5f, 4}};
  Rng rng(6);
  const nn::PointSet points = make_example(scene, symmetry, 0, 5, &rng).points;
  // One solution for the lights as they shine together.
  const auto triples = [](const at::Tensor& t) {
    return std::span(reinterpret_cast<const Vec3*>(t.const_data_ptr<float>()),
                     static_cast<size_t>(t.size(0)));
  };
  const radiosity::PointIrradiance light = radiosity::solve(
      {triples(points.position), triples(points.normal), triples(points.albedo),
       triples(points.emission),
       std::span(points.area.const_data_ptr<float>(), static_cast<size_t>(points.area.size(0)))},
      1);
  double sum = 0;
  for (size_t i = 0; i < light.indirect.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const float expected = light.indirect[i][c];
      EXPECT_NEAR(triples(points.indirect)[i][c], expected, 1e-4f + 1e-4f * expected);
      sum += expected;
    }
  }
  EXPECT_GT(sum, 0);
}

TEST(MakeExample, LightOnScenePointsIsSummedOverGroupsUnderTheirGains) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(7);
  sample.name = "room";
  const std::filesystem::path path = dir / "room.safetensors";
  data::write_scene_sample(path, sample);
  try {
    read_training_scene(path, "room", nn::LightInput::Traced);
    ADD_FAILURE() << "read light that is not there";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("room.safetensors"),
                               testing::HasSubstr("scene_direct"), testing::HasSubstr("traced")));
  }
  const size_t M = sample.scene_position.size();
  Rng random(3);
  for (auto* light : {&sample.scene_direct, &sample.scene_indirect}) {
    light->resize(2 * M);
    for (Rgb& value : *light) value = {random.uniform(), random.uniform(), random.uniform()};
  }
  sample.scene_direct_back.assign(2 * M, Rgb{});
  sample.scene_indirect_back.assign(2 * M, Rgb{});
  sample.scene_error.assign(2 * M, to_half(0.25f));
  sample.scene_error_back.assign(2 * M, to_half(0.0f));
  data::write_scene_sample(path, sample);
  const TrainingScene scene = read_training_scene(path, "room", nn::LightInput::Traced);
  Symmetry symmetry = identity_symmetry(2);
  symmetry.gains = {{2, 1, 0}, {0, 0.5f, 3}};
  Rng rng(6);
  const Example example = make_example(scene, symmetry, static_cast<int64_t>(M), 5, &rng);
  // Rows are drawn in an order of their own: positions tell which.
  for (int64_t row = 0; row < example.points.position.size(0); ++row) {
    size_t i = 0;
    const at::Tensor p = example.points.position[row];
    const Vec3 at{p[0].item<float>(), p[1].item<float>(), p[2].item<float>()};
    while (i < M && !(scene.position[i] == at)) ++i;
    ASSERT_LT(i, M);
    for (int c = 0; c < 3; ++c) {
      const Rgb &a = symmetry.gains[0], &b = symmetry.gains[1];
      EXPECT_FLOAT_EQ(example.points.direct[row][c].item<float>(),
                      a[c] * sample.scene_direct[i][c] + b[c] * sample.scene_direct[M + i][c]);
      EXPECT_FLOAT_EQ(example.points.indirect[row][c].item<float>(),
                      a[c] * sample.scene_indirect[i][c] + b[c] * sample.scene_indirect[M + i][c]);
    }
  }
}

/// The channels' mean of the light of a row.
double gray(const at::Tensor& row) { return row.mean().item<double>(); }

TEST(MakeExample, SymmetriesActOnBothSidesOfTheLight) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(7);
  const std::filesystem::path path = dir / "room.safetensors";
  const size_t M = sample.scene_position.size();
  Rng random(3);
  for (auto* light : {&sample.scene_direct_back, &sample.scene_indirect_back}) {
    light->resize(2 * M);
    for (Rgb& value : *light) value = {random.uniform(), random.uniform(), random.uniform()};
  }
  sample.scene_direct = sample.scene_direct_back;
  sample.scene_indirect = sample.scene_indirect_back;
  const auto refused = [&] {
    data::SceneSample old = sample;
    old.scene_direct_back.clear();
    old.scene_indirect_back.clear();
    data::write_scene_sample(path, old);
    read_training_scene(path, "room", nn::LightInput::Traced);
  };
  test::expect_error(refused, {"room.safetensors", "no scene_direct_back", "light_input traced"});
  for (Rgb& value : sample.scene_indirect) value += Rgb{1, 2, 3};  // the front, in every group
  sample.scene_error.assign(2 * M, to_half(0.25f));
  sample.scene_error_back.assign(2 * M, to_half(1.0f));
  data::write_scene_sample(path, sample);
  const TrainingScene scene = read_training_scene(path, "room", nn::LightInput::Traced);
  Symmetry symmetry = identity_symmetry(2);
  symmetry.mirror = true;
  symmetry.channels = {2, 0, 1};
  symmetry.gains = {{2, 1, 0}, {0, 0.5f, 3}};
  Symmetry single = symmetry;
  single.gains[1] = {0, 0, 0};
  for (const Symmetry& drawn : {symmetry, single}) {
    Rng rng(6);
    const Example example = make_example(scene, drawn, 0, 5, &rng);
    ASSERT_EQ(example.points.position.size(0), static_cast<int64_t>(M));
    for (size_t i = 0; i < M; ++i) {
      const auto row = static_cast<int64_t>(i);
      double error[2] = {0, 0};
      for (size_t g = 0; g < 2; ++g) {
        const Rgb gain = drawn.gains[g], of_back = sample.scene_indirect_back[g * M + i] * gain,
                  of_front = Rgb{1, 2, 3} * gain;
        error[0] += std::pow(0.25 * (of_front.x + of_front.y + of_front.z) / 3, 2);
        error[1] += std::pow((of_back.x + of_back.y + of_back.z) / 3, 2);
      }
      for (int c = 0; c < 3; ++c) {
        const int from = drawn.channels[static_cast<size_t>(c)];
        double direct = 0, indirect = 0;
        for (size_t g = 0; g < 2; ++g) {
          direct += drawn.gains[g][from] * sample.scene_direct_back[g * M + i][from];
          indirect += drawn.gains[g][from] * sample.scene_indirect_back[g * M + i][from];
        }
        EXPECT_NEAR(example.points.direct_back[row][c].item<float>(), direct, 1e-5);
        EXPECT_NEAR(example.points.indirect_back[row][c].item<float>(), indirect, 1e-5);
      }
      const at::Tensor back = example.points.indirect_back[row],
                       front = example.points.indirect[row] - back,
                       given = example.points.indirect_error[row];
      EXPECT_NEAR(given[0].item<double>() * gray(front), std::sqrt(error[0]), 1e-4);
      EXPECT_NEAR(given[1].item<double>() * gray(back), std::sqrt(error[1]), 1e-4);
    }
  }
}

TEST(SceneStore, DropsTheLeastRecentlyUsed) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 3, 0);
  const auto entries = data::entries_of(data::read_dataset_info(dir.path()), data::Split::Train);
  SceneStore probe(dir.path(), entries, {});
  const size_t one = probe.get(0)->size_bytes();
  SceneStore store(dir.path(), entries, {2 * one});
  const auto first = store.get(0);
  store.get(1);
  EXPECT_EQ(store.get(0), first) << "still kept";
  store.get(2);  // drops 1
  EXPECT_EQ(store.get(0), first);
  EXPECT_EQ(store.cached_bytes(), 2 * one);
  EXPECT_EQ(probe.cached_bytes(), one) << "the latest stays whatever the limit";
}

TEST(SceneStore, GivesSeveralAsItGivesOneByOne) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 4, 0);
  const auto entries = data::entries_of(data::read_dataset_info(dir.path()), data::Split::Train);
  std::filesystem::remove(data::scene_path(dir.path(), entries[1].name));
  SceneStoreOptions options{size_t{1} << 30};
  options.skip_bad = true;
  SceneStore store(dir.path(), entries, options), each(dir.path(), entries, options);
  const auto kept = store.get(3);
  const std::vector<size_t> wanted = {2, 1, 3, 0, 2};
  const auto scenes = store.get(wanted);
  ASSERT_EQ(scenes.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto right = each.get(wanted[i]);
    ASSERT_EQ(scenes[i] == nullptr, right == nullptr) << i;
    if (right) {
      EXPECT_EQ(scenes[i]->name, right->name) << i;
    }
  }
  EXPECT_EQ(scenes[1], nullptr) << "its file is gone";
  EXPECT_EQ(scenes[2], kept);
  EXPECT_EQ(scenes[0], scenes[4]) << "asked for twice at once";
  EXPECT_EQ(store.bad(), std::set<size_t>{1});
  EXPECT_EQ(store.cached_bytes(), each.cached_bytes());
  SceneStore strict(dir.path(), entries, {size_t{1} << 30});
  EXPECT_THROW(strict.get(wanted), Error);
}

TEST(SceneStore, TheTargetIsIndirect) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 1, 0);
  const std::filesystem::path path = data::scene_path(dir.path(), "room0");
  EXPECT_EQ(read_training_scene(path, "room0").target, data::read_scene_sample(path).indirect);
}

}  // namespace
}  // namespace lte::train
