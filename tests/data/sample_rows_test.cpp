#include "lte/data/sample_rows.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/data/sample_fixture.h"

namespace lte::data::test {
namespace {

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
  std::vector<int32_t> light(1000, -1);
  std::fill(light.begin(), light.begin() + 3, 0);
  std::fill(light.begin() + 3, light.begin() + 53, 1);
  Rng rng(3);
  for (int draw = 0; draw < 20; ++draw) {
    std::map<int32_t, int> kept;
    for (const int64_t row : draw_scene_rows(light, 100, &rng))
      ++kept[light[static_cast<size_t>(row)]];
    EXPECT_EQ(kept[0], 1);  // three in a thousand, of a hundred: still there
    EXPECT_EQ(kept[1], 5);
    EXPECT_EQ(kept[-1], 94);
  }
}

TEST(DrawSceneRows, DrawsAsManyAsAreAskedFor) {
  Rng rng(4);
  for (int scene = 0; scene < 200; ++scene) {
    // Up to forty lights of one to nine points each, and the rest.
    std::vector<int32_t> light(1000, -1);
    size_t at = 0;
    const auto lights = static_cast<int32_t>(rng.below(41));
    for (int32_t i = 0; i < lights; ++i) {
      for (uint64_t k = rng.below(9) + 1; k > 0; --k) light[at++] = i;
    }
    for (const int64_t count : {int64_t{41}, int64_t{100}, int64_t{512}, int64_t{999}}) {
      const std::vector<int64_t> rows = draw_scene_rows(light, count, &rng);
      EXPECT_EQ(static_cast<int64_t>(rows.size()), count) << lights << " lights";
      EXPECT_EQ(std::set<int64_t>(rows.begin(), rows.end()).size(), rows.size());
      std::map<int32_t, int64_t> kept;
      for (const int64_t row : rows) ++kept[light[static_cast<size_t>(row)]];
      for (int32_t i = 0; i < lights; ++i) EXPECT_GE(kept[i], 1);
    }
  }
}

TEST(DrawSceneRows, KeepsALightsPointWhereThereAreMoreLightsThanPoints) {
  std::vector<int32_t> light(100);
  for (int32_t i = 0; i < 100; ++i) light[static_cast<size_t>(i)] = i / 5;  // twenty lights
  Rng rng(5);
  EXPECT_EQ(draw_scene_rows(light, 8, &rng).size(), 20u);
}

/// 1,000 points on a line, of which each tensor says the place; three are of a bright group and
/// fifty of another, on a tenth of the area that the rest have.
SceneSample line_of_points() {
  SceneSample sample;
  sample.seed = 5;
  sample.light_groups = 2;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i);
    sample.scene_position.push_back({x, 0, 0});
    sample.scene_normal.push_back({0, 1, 0});
    sample.scene_albedo.push_back({x / 1000, 0, 0});
    sample.scene_light.push_back(i < 3 ? 0 : i < 53 ? 1 : -1);
    sample.scene_emission.push_back(i < 53 ? Rgb{x, 0, 0} : Rgb{});
    sample.scene_area.push_back(i < 53 ? 0.01f : 0.1f);
  }
  for (int g = 0; g < 2; ++g) {
    for (int i = 0; i < 1000; ++i) {
      const auto value = static_cast<float>(1000 * g + i);
      sample.scene_direct.push_back({value, 0, 0});
      sample.scene_direct_back.push_back({0, value, 0});
      sample.scene_error.push_back(to_half(value / 2000));
    }
  }
  sample.scene_indirect = sample.scene_direct;
  sample.scene_indirect_back = sample.scene_direct_back;
  sample.scene_error_back = sample.scene_error;
  return sample;
}

TEST(ThinScenePoints, KeepsEveryTensorOfAPointTogether) {
  SceneSample sample = line_of_points();
  thin_scene_points(&sample, 100);
  const auto M = static_cast<size_t>(sample.scene_points());
  EXPECT_EQ(M, 100u);
  std::set<float> places;
  for (size_t i = 0; i < M; ++i) {
    const float x = sample.scene_position[i].x;
    places.insert(x);
    EXPECT_EQ(sample.scene_albedo[i].x, x / 1000);
    EXPECT_EQ(sample.scene_emission[i].x, x < 53 ? x : 0);
    EXPECT_EQ(sample.scene_light[i], x < 3 ? 0 : x < 53 ? 1 : -1);
    for (size_t g = 0; g < 2; ++g) {
      const float value = 1000.0f * static_cast<float>(g) + x;
      EXPECT_EQ(sample.scene_direct[g * M + i].x, value);
      EXPECT_EQ(sample.scene_indirect_back[g * M + i].y, value);
      EXPECT_NEAR(to_float(sample.scene_error[g * M + i]), value / 2000, 1e-3);
    }
  }
  EXPECT_EQ(places.size(), M) << "no point twice";
  EXPECT_TRUE(sample.scene_metallic.empty()) << "what was not there is still not there";
}

TEST(ThinScenePoints, KeepsTheAreaOfEachLuminaire) {
  SceneSample sample = line_of_points();
  thin_scene_points(&sample, 100);
  std::map<int32_t, double> area;
  for (size_t i = 0; i < sample.scene_area.size(); ++i)
    area[sample.scene_light[i]] += sample.scene_area[i];
  EXPECT_NEAR(area[0], 0.03, 1e-6);
  EXPECT_NEAR(area[1], 0.5, 1e-6);
  EXPECT_NEAR(area[-1], 94.7, 1e-4);
}

TEST(ThinScenePoints, IsTheSameEachTimeAndNothingWhereNoneAreTooMany) {
  SceneSample first = line_of_points(), second = line_of_points(), whole = line_of_points();
  thin_scene_points(&first, 100);
  thin_scene_points(&second, 100);
  EXPECT_EQ(first.scene_position, second.scene_position);
  for (const int64_t count : {0, 1000, 5000}) {
    thin_scene_points(&whole, count);
    EXPECT_EQ(whole.scene_points(), 1000);
  }
  EXPECT_NE(error_of([&] { thin_scene_points(&whole, -1); }), "");
}

TEST(DropIdleQueries, RemovesWhatNoGroupLightsAndKeepsTheRest) {
  SceneSample sample;
  sample.light_groups = 2;
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i);
    sample.query_position.push_back({x, 0, 0});
    sample.query_normal.push_back({0, 1, 0});
    sample.query_albedo.push_back(i < 4 ? Rgb{x + 1, 0, 0} : Rgb{});
    sample.variance.push_back(x);
    sample.query_rays.push_back(i);
  }
  // Point 0 has indirect light of group 1 only, point 2 direct light of group 0 only; 1 and 3 have
  // none; 4 is lit, but black.
  sample.direct = {{}, {}, {5, 0, 0}, {}, {9, 0, 0}, {}, {}, {}, {}, {}};
  sample.indirect = {{}, {}, {}, {}, {}, {0, 0, 7}, {}, {}, {}, {8, 0, 0}};
  View view;
  view.albedo = {{0, 0, 0}, {0, 0.1f, 0}, {0, 0, 0}, {1, 1, 1}};
  view.mask = {1, 1, 0, 1};
  sample.views = {view};
  EXPECT_EQ(drop_idle_queries(&sample), 3);
  EXPECT_EQ(sample.views[0].mask, (std::vector<uint8_t>{0, 1, 0, 1}));
  EXPECT_EQ(sample.query_position, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}}));
  EXPECT_EQ(sample.variance, (std::vector<float>{0, 2}));
  EXPECT_EQ(sample.query_rays, (std::vector<int32_t>{0, 2}));
  EXPECT_EQ(sample.direct, (std::vector<Rgb>{{}, {5, 0, 0}, {}, {}}));
  EXPECT_EQ(sample.indirect, (std::vector<Rgb>{{}, {}, {0, 0, 7}, {}}));
  EXPECT_EQ(drop_idle_queries(&sample), 0);
}

TEST(DropIdleQueries, KeepsABlackSceneWhole) {
  SceneSample sample;
  sample.light_groups = 1;
  sample.query_position = sample.query_normal = sample.query_albedo = {{0, 1, 0}};
  sample.direct = sample.indirect = {{}};
  sample.variance = {0};
  EXPECT_EQ(drop_idle_queries(&sample), 0);
  EXPECT_EQ(sample.query_points(), 1);
}

}  // namespace
}  // namespace lte::data::test
