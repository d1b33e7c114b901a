#include "lte/nn/encoder/encoder_plan.h"

#include <set>

#include <gtest/gtest.h>

#include "lte/ops/curve_codes.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

std::vector<int64_t> list(const at::Tensor& t) {
  const at::Tensor host = t.to(at::kLong).contiguous();
  return {host.const_data_ptr<int64_t>(), host.const_data_ptr<int64_t>() + host.numel()};
}

TEST(PatchMap, LastPatchBorrowsFromTheOneBefore) {
  EXPECT_EQ(list(make_patch_map(torch::arange(10), 4).gather),
            (std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 6, 7}));
  EXPECT_EQ(list(make_patch_map(torch::arange(5), 4).gather),
            (std::vector<int64_t>{0, 1, 2, 3, 4, 1, 2, 3}));
  EXPECT_EQ(list(make_patch_map(torch::arange(8), 4).gather),
            (std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(PatchMap, InverseFindsEveryPointInItsOwnSlot) {
  torch::manual_seed(1);
  for (const int64_t n : {3, 7, 8, 9, 64, 101}) {
    const PatchMap map = make_patch_map(torch::randperm(n), 2);
    EXPECT_EQ(map.gather.size(0) % 2, 0);
    EXPECT_TRUE(torch::equal(map.gather.index_select(0, map.inverse), torch::arange(n)));
    EXPECT_LT(map.inverse.max().item<int64_t>(), n) << "a padded slot was read back";
  }
}

TEST(EncoderPlan, StagesPoolByCoarserCellInZOrder) {
  torch::manual_seed(2);
  const at::Tensor cells = torch::randint(40, {300, 3}, at::kInt);
  ModelConfig config = test::tiny_config();
  const auto stages = make_stages(cells, config, false, {0});
  ASSERT_EQ(stages.size(), 3u);
  for (size_t s = 1; s < stages.size(); ++s) {
    const at::Tensor parent = stages[s - 1].cells.bitwise_right_shift(1);
    EXPECT_TRUE(torch::equal(stages[s].cells.index_select(0, stages[s].cluster), parent));
    std::set<std::vector<int64_t>> distinct;
    for (int64_t i = 0; i < parent.size(0); ++i) distinct.insert(list(parent[i]));
    EXPECT_EQ(stages[s].points(), static_cast<int64_t>(distinct.size()));
    const at::Tensor code = ops::curve_codes(stages[s].cells, ops::Curve::Z, 16);
    EXPECT_TRUE((code.slice(0, 1) > code.slice(0, 0, -1)).all().item<bool>());
  }
}

TEST(EncoderPlan, OneCurveABlockAndNoneForASinglePatch) {
  torch::manual_seed(2);
  ModelConfig config = test::tiny_config();
  config.encoder_depths = {6, 1, 3};
  const at::Tensor line = torch::arange(64, at::kInt).unsqueeze(1).expand({64, 3}).contiguous();
  const auto stages = make_stages(line, config, false, {0});
  EXPECT_EQ(stages[0].scenes[0].patches.size(), 4u);  // there are four curves
  EXPECT_EQ(stages[1].scenes[0].patches.size(), 1u);
  EXPECT_EQ(stages[2].scenes[0].patches.size(), 3u);
  config.patch_size = 32;
  const auto wide = make_stages(line, config, false, {0});
  EXPECT_TRUE(wide[0].scenes[0].patches[0].gather.defined());
  ASSERT_EQ(wide[1].scenes[0].patches.size(), 1u);
  EXPECT_FALSE(wide[1].scenes[0].patches[0].gather.defined());
}

TEST(EncoderPlan, PatchesFollowTheCurve) {
  torch::manual_seed(4);
  const at::Tensor cells = torch::randint(500, {50, 3}, at::kInt);
  ModelConfig config = test::tiny_config();
  config.encoder_depths = {4, 0, 0};
  const auto stages = make_stages(cells, config, false, {0});
  for (size_t i = 0; i < 4; ++i) {
    const at::Tensor code = ops::curve_codes(cells, static_cast<ops::Curve>(i), 16);
    const at::Tensor along =
        code.index_select(0, stages[0].scenes[0].patches[i].gather.narrow(0, 0, 50));
    EXPECT_TRUE((along.slice(0, 1) >= along.slice(0, 0, -1)).all().item<bool>()) << "curve " << i;
  }
}

TEST(EncoderPlan, ShuffleIsDrawnFromTheSeed) {
  torch::manual_seed(4);
  const at::Tensor cells = torch::randint(500, {200, 3}, at::kInt);
  const ModelConfig config = test::tiny_config();
  std::set<std::vector<int64_t>> first;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const auto order = [&] {
      return list(make_stages(cells, config, true, {seed})[0].scenes[0].patches[0].gather);
    };
    EXPECT_EQ(order(), order());
    first.insert(order());
  }
  EXPECT_EQ(first.size(), 4u);
}

TEST(EncoderPlan, SpacingIsThatOfTheSparsestSetAndCoincidentPointsHaveOne) {
  const at::Tensor line =
      torch::arange(17).to(at::kFloat).unsqueeze(1).mul(torch::tensor({{1.0f, 0.0f, 0.0f}})) / 16;
  const EncoderPlan plan = make_encoder_plan(line, test::tiny_config(), false, 0);
  EXPECT_EQ(plan.position.size(0), 5);  // 17 -> 9 -> 5: ends, middle, quarters
  EXPECT_FLOAT_EQ(static_cast<float>(plan.spacing[0]), 0.25f);
  const EncoderPlan same = make_encoder_plan(torch::zeros({33, 3}), test::tiny_config(), false, 0);
  EXPECT_GT(same.spacing[0], 0);
  EXPECT_EQ(same.stages[0].points(), 9);
  EXPECT_EQ(same.stages[1].points(), 1);
}

TEST(GridCells, GridGrowsWhereSixteenBitsWouldNotDo) {
  double grid = 1e-7;
  const at::Tensor cells =
      grid_cells(torch::tensor({{0.0f, 0.0f, 0.0f}, {1.0f, 0.5f, 0.0f}}), &grid);
  EXPECT_GT(grid, 1e-7);
  EXPECT_EQ(cells.max().item<int>(), 65535);
  grid = 0.25;
  EXPECT_EQ(list(grid_cells(torch::tensor({{0.0f, 0.25f, 0.9f}}), &grid)),
            (std::vector<int64_t>{0, 1, 3}));
  EXPECT_EQ(grid, 0.25);
}

}  // namespace
}  // namespace lte::nn
