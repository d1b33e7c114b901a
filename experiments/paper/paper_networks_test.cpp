#include <cmath>

#include <gtest/gtest.h>
#include <torch/types.h>

#include "experiments/paper/by_heart_models.h"
#include "experiments/paper/roadmap_model.h"
#include "lte/nn/synthetic_room.h"

namespace lte::experiments {
namespace {

nn::ModelConfig narrow() {
  nn::ModelConfig config;
  config.channels = 32;
  config.dropout = 0;
  config.encoder_depths = {1, 1};
  config.encoder_widths = {1, 1};
  config.decoder_depths = {1};
  config.decoder_widths = {1};
  config.query_layers = 2;
  config.query_neighbours = 8;
  return config;
}

nn::QuerySet queries_of(int64_t count) {
  const nn::PointSet places = nn::synthetic_room(count, 5);
  return {places.position, places.normal, places.albedo};
}

TEST(GlobalAttention, IsTheSameFusedAndStored) {
  GlobalAttention fused(64, 2, Attention::Fused), stored(64, 2, Attention::Stored);
  const at::NoGradGuard no_grad;
  for (const auto& parameter : fused->named_parameters())
    stored->named_parameters()[parameter.key()].copy_(parameter.value());
  const at::Tensor x = torch::randn({37, 64}), context = torch::randn({51, 64});
  EXPECT_TRUE(torch::allclose(fused->forward(x, context), stored->forward(x, context), 1e-4, 1e-5));
}

TEST(NeighbourMean, ReadsTheNearestFeaturesAlone) {
  torch::manual_seed(2);
  const nn::ModelConfig config = narrow();
  NeighbourMean pool(4, config);
  const at::NoGradGuard no_grad;
  const at::Tensor anchor = torch::arange(40).to(at::kFloat).div(40).view({40, 1}).repeat({1, 3}),
                   position = torch::zeros({1, 3}), attributes = torch::randn({1, 9});
  at::Tensor features = torch::randn({40, 4});
  const at::Tensor before = pool->forward(attributes, position, anchor, features);
  features.slice(0, config.query_neighbours) += 1;
  EXPECT_TRUE(torch::equal(before, pool->forward(attributes, position, anchor, features)));
  features.slice(0, 0, config.query_neighbours) =
      features.slice(0, 0, config.query_neighbours).flip(0);  // a mean knows no order
  EXPECT_TRUE(
      torch::allclose(before, pool->forward(attributes, position, anchor, features), 1e-5, 1e-6));
  features[0] += 1;
  EXPECT_FALSE(torch::equal(before, pool->forward(attributes, position, anchor, features)));
}

TEST(Roadmap, VanillaKnowsNoOrderOfScenePoints) {
  torch::manual_seed(3);
  RoadmapModel model(RoadmapNetwork::Vanilla, narrow());
  const at::NoGradGuard no_grad;
  nn::PointSet points = nn::synthetic_room(200, 4);
  const nn::QuerySet queries = queries_of(50);
  const at::Tensor before = model->forward(points, queries, 1);
  const at::Tensor order = torch::randperm(200);
  for (at::Tensor* column : points.tensors()) {
    if (column->defined()) *column = column->index_select(0, order);
  }
  EXPECT_TRUE(torch::allclose(before, model->forward(points, queries, 1), 1e-4, 1e-5));
}

TEST(Roadmap, EveryTrainedParameterHasAGradient) {
  for (const RoadmapNetwork network :
       {RoadmapNetwork::Vanilla, RoadmapNetwork::Encoder, RoadmapNetwork::Whole}) {
    torch::manual_seed(4);
    RoadmapModel model(network, narrow());
    model->train();
    model->forward(nn::synthetic_room(300, 6), queries_of(64), 1).square().mean().backward();
    for (const auto& parameter : model->named_parameters()) {
      if (!parameter.value().requires_grad()) continue;
      ASSERT_TRUE(parameter.value().grad().defined()) << parameter.key();
      EXPECT_TRUE(parameter.value().grad().isfinite().all().item<bool>()) << parameter.key();
    }
  }
}

TEST(HashGrid, InterpolatesBetweenCorners) {
  torch::manual_seed(5);
  HashGridConfig config;
  config.levels = 3;
  HashGrid grid(config);  // 16, 24 and 36 cells: the last of more corners than 2^15 entries
  const at::NoGradGuard no_grad;
  const at::Tensor anywhere = torch::rand({200, 3});
  for (int64_t level = 0; level < config.levels; ++level) {
    const auto [index, weight] = grid->corners(anywhere, level);
    EXPECT_TRUE(torch::allclose(weight.sum(1), torch::ones({200}), 1e-6, 1e-6));
    EXPECT_GE(index.min().item<int64_t>(), 0);
    EXPECT_LT(index.max().item<int64_t>(), int64_t{1} << config.log2_entries);
  }
  // In a cell of the finest level each feature is linear along an axis.
  const double cell = 1.0 / static_cast<double>(grid->cells(2));
  const auto at_x = [&](double x) {
    return grid->forward(torch::tensor({{x * cell, 0.3 * cell, 0.6 * cell}}));
  };
  EXPECT_TRUE(torch::allclose(at_x(0.5), 0.5 * (at_x(0.25) + at_x(0.75)), 1e-4, 1e-8));
  EXPECT_TRUE(torch::allclose(at_x(1 - 1e-5), at_x(1 + 1e-5), 1e-2, 1e-7));  // and continuous
  const at::Tensor corner = grid->forward(torch::zeros({1, 3}));
  EXPECT_TRUE(torch::allclose(corner.view({3, 2}), grid->table().select(1, 0)));
}

}  // namespace
}  // namespace lte::experiments
