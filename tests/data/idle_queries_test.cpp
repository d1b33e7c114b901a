#include <gtest/gtest.h>

#include "lte/data/scene_sample.h"

namespace lte::data::test {
namespace {

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
