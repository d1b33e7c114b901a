// What is recorded of attention against the passes that answer, and against definitions.
#include "lte/nn/encoder/attention_record.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/nn/encoder/transformer_block.h"
#include "lte/nn/model.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

class RecordOf : public testing::TestWithParam<ModelConfig> {};

template <typename Module>
Module& child(TransformerBlock& block, const std::string& name) {
  return *block->named_children()[name]->as<Module>();
}

TEST_P(RecordOf, ABlockReproducesItsOutputFromRowsThatSumToOne) {
  const at::NoGradGuard no_grad;
  const ModelConfig config = GetParam();
  for (const int64_t n : {6, 22}) {  // one patch of all, and three, of which the last borrows slots
    torch::manual_seed(4);
    const StagePlan stage =
        make_stages(torch::randint(6, {n, 3}, at::kInt), config, false, {0}).front();
    const int64_t C = config.channels;
    TransformerBlock block(C, config);
    test::randomize(*block, 3);
    block->eval();
    const at::Tensor x = torch::randn({n, C});
    for (const size_t order : {0, 1}) {
      const BlockAttention record = block->record_attention(x, stage, order);
      ASSERT_EQ(record.points(), n);
      const int64_t H = record.heads, width = C / H;
      ASSERT_GT(H, 1);
      at::Tensor attended = torch::empty({n, C});
      for (int64_t i = 0; i < n; ++i) {
        const at::Tensor weights = record.weights(i);
        EXPECT_LT((weights.sum(1) - 1).abs().max().item<double>(), 1e-6);
        EXPECT_EQ((weights[0] > 0).sum().item<int64_t>(), std::min(n, config.patch_size));
        const at::Tensor value = record.qkv.narrow(1, 2 * C, C).view({n, H, width});
        attended[i].copy_(torch::einsum("hn,nhc->hc", {weights, value}).reshape({C}));
      }
      const auto& attention = child<PatchAttentionImpl>(block, "attention");
      const auto p = attention.named_parameters();
      const at::Tensor y =
          x + child<PointNormImpl>(block, "conv_norm")
                  .forward(child<LinearImpl>(block, "conv_linear")
                               .forward(child<SubmanifoldConvImpl>(block, "conv")
                                            .forward(x, stage.pairs, stage.tap_begin)),
                           stage);
      const at::Tensor z = y + attended.matmul(p["proj.weight"].t()) + p["proj.bias"];
      const at::Tensor out =
          z + child<MlpImpl>(block, "mlp")
                  .forward(child<torch::nn::LayerNormImpl>(block, "norm2").forward(z));
      EXPECT_LT((out - block->forward(x, stage, order)).abs().max().item<double>(), 1e-4)
          << n << " points, order " << order;
    }
  }
}

/// A model of random weights in evaluation mode.
LightTransportModel random_model(const ModelConfig& config) {
  LightTransportModel model(config);
  test::randomize(*model, 8);
  model->eval();
  return model;
}

TEST_P(RecordOf, AnEncodingLeavesItsAnswersAsTheyAre) {
  const at::NoGradGuard no_grad;
  LightTransportModel model = random_model(GetParam());
  const PointSet points = test::box_scene(150, 2);
  const QuerySet queries = test::box_queries(40, 3);
  EncoderAttention record;
  const Embedding plain = model->encode(points), recorded = model->encode(points, 0, {}, &record);
  EXPECT_TRUE(torch::equal(plain.features, recorded.features));
  EXPECT_TRUE(torch::equal(plain.table, recorded.table));
  EXPECT_TRUE(torch::equal(model->decode(plain, queries), model->decode(recorded, queries)));
}

TEST_P(RecordOf, AnEncodingHasEveryBlockOverTheSameLatents) {
  const at::NoGradGuard no_grad;
  const ModelConfig config = GetParam();
  LightTransportModel model = random_model(config);
  const PointSet points = test::box_scene(150, 2);
  EncoderAttention record;
  const Embedding embedding = model->encode(points, 0, {}, &record);
  const int64_t m = embedding.position.size(0);
  std::vector<std::string> names;
  for (const BlockAttention& block : record.blocks) names.push_back(block.name);
  EXPECT_EQ(names, (std::vector<std::string>{"down0.0", "down1.0", "down2.0", "down2.1", "up1.0",
                                             "up0.0", "up0.1"}));
  const at::Tensor there = points.position.index_select(0, record.scene_point);
  const at::Tensor here = embedding.position * embedding.scale + embedding.origin;
  EXPECT_LT((there - here).abs().max().item<double>(), 1e-4);
  EXPECT_TRUE(torch::equal(record.normal, points.normal.index_select(0, record.scene_point)));
  // A latent is part of the point whose cell has its own in it.
  const EncoderPlan plan = make_encoder_plan(
      (points.position - embedding.origin).div(embedding.scale).contiguous(), config, false, 0);
  for (size_t level = 0; level < plan.stages.size(); ++level) {
    const at::Tensor cells =
        plan.stages[level].cells.index_select(0, record.point_of_latent.at(level));
    EXPECT_TRUE(
        torch::equal(cells, plan.stages[0].cells.bitwise_right_shift(static_cast<int64_t>(level))));
  }
  for (size_t b = 0; b < record.blocks.size(); ++b) {
    const at::Tensor weights = record.weights(b, m / 2);
    EXPECT_EQ(weights.size(1), plan.stages[record.blocks[b].level].points());
    EXPECT_LT((weights.sum(1) - 1).abs().max().item<double>(), 1e-6) << names[b];
  }
  // The health of a stage has the mean over its blocks.
  for (const StageHealth& stage : model->stage_health(points)) {
    double sum = 0;
    int count = 0;
    for (const BlockAttention& block : record.blocks) {
      if (!block.name.starts_with(stage.stage + '.')) continue;
      sum += block.entropy();
      ++count;
    }
    if (count == 0) continue;
    if (std::isnan(sum)) {  // a stage of one point has nothing to choose from
      EXPECT_TRUE(std::isnan(stage.entropy)) << stage.stage;
      continue;
    }
    EXPECT_NEAR(stage.entropy, sum / count, 1e-9) << stage.stage;
  }
}

TEST_P(RecordOf, AQuerysWeightsLeadToItsAnswer) {
  const at::NoGradGuard no_grad;
  const ModelConfig config = GetParam();
  LightTransportModel model = random_model(config);
  const Embedding embedding = model->encode(test::box_scene(150, 2));
  const QuerySet queries = test::box_queries(30, 3);
  const DecoderReading reading = model->read(embedding, queries);
  const int64_t K = config.query_neighbours, L = config.query_layers;
  ASSERT_EQ(reading.weights.sizes(), (std::vector<int64_t>{L, 30, K, config.channels}));
  ASSERT_EQ(reading.values.sizes(), reading.weights.sizes());
  EXPECT_LT(test::relative_difference(reading.answer, model->decode_normalized(embedding, queries)),
            1e-4);
  // The neighbours by brute force, in float64; which of two equally far ones comes first is open.
  const at::Tensor here =
      (queries.position - embedding.origin).div(embedding.scale).to(at::kDouble);
  const at::Tensor distance =
      (here.unsqueeze(1) - embedding.position.to(at::kDouble).unsqueeze(0)).norm(2, 2);
  const at::Tensor nearest = std::get<0>(distance.topk(K, 1, /*largest=*/false));
  EXPECT_LT((distance.gather(1, reading.index) - nearest).abs().max().item<double>(), 1e-6);
  const at::Tensor shares = reading.shares();
  EXPECT_LT((shares.sum(2) - 1).abs().max().item<double>(), 1e-6);
  EXPECT_GE(shares.min().item<double>(), 0);
}

std::vector<ModelConfig> configurations() {
  ModelConfig traced = test::tiny_geometric_config();
  traced.light_input = LightInput::Traced;
  return {test::tiny_config(), test::tiny_geometric_config(), traced};
}

std::string configuration_name(const testing::TestParamInfo<ModelConfig>& of) {
  constexpr std::array kNames = {"Tiny", "Geometric", "Traced"};
  return kNames.at(of.index);
}

INSTANTIATE_TEST_SUITE_P(Configurations, RecordOf, testing::ValuesIn(configurations()),
                         configuration_name);

TEST(BlockAttention, RefusesAPointThatIsNotThere) {
  BlockAttention block;
  block.qkv = torch::zeros({3, 6});
  EXPECT_EQ(block.weights(2).size(1), 3);
  test::expect_error([&] { block.weights(3); }, {"point 3 of 3"});
}

}  // namespace
}  // namespace lte::nn
