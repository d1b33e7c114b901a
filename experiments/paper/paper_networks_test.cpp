#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <torch/types.h>

#include "experiments/paper/by_heart_models.h"
#include "experiments/paper/deep_shading.h"
#include "experiments/paper/point_draw.h"
#include "experiments/paper/point_network.h"
#include "experiments/paper/roadmap_model.h"
#include "experiments/paper/view_camera.h"
#include "lte/nn/points/synthetic_room.h"

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
  const at::Tensor before = model->forward({points}, {queries}, {1})[0];
  const at::Tensor order = torch::randperm(200);
  for (at::Tensor* column : points.tensors()) {
    if (column->defined()) *column = column->index_select(0, order);
  }
  EXPECT_TRUE(torch::allclose(before, model->forward({points}, {queries}, {1})[0], 1e-4, 1e-5));
}

TEST(Roadmap, ScenesOfOnePassDoNotSeeOneAnother) {
  for (const RoadmapNetwork network :
       {RoadmapNetwork::Vanilla, RoadmapNetwork::Encoder, RoadmapNetwork::Whole}) {
    torch::manual_seed(5);
    RoadmapModel model(network, narrow());
    model->eval();
    const at::NoGradGuard no_grad;
    const nn::PointSet first = nn::synthetic_room(200, 4), second = nn::synthetic_room(200, 9);
    const nn::QuerySet queries = queries_of(30);
    const auto both = model->forward({first, second}, {queries, queries}, {1, 2});
    ASSERT_EQ(both.size(), 2u);
    EXPECT_TRUE(torch::allclose(both[0], model->forward({first}, {queries}, {1})[0], 1e-3, 1e-4));
    EXPECT_TRUE(torch::allclose(both[1], model->forward({second}, {queries}, {2})[0], 1e-3, 1e-4));
    EXPECT_FALSE(torch::allclose(both[0], both[1], 1e-3, 1e-4));
  }
}

TEST(Roadmap, EveryTrainedParameterHasAGradient) {
  for (const RoadmapNetwork network :
       {RoadmapNetwork::Vanilla, RoadmapNetwork::Encoder, RoadmapNetwork::Whole}) {
    torch::manual_seed(4);
    RoadmapModel model(network, narrow());
    model->train();
    model->forward({nn::synthetic_room(300, 6)}, {queries_of(64)}, {1})[0]
        .square()
        .mean()
        .backward();
    for (const auto& parameter : model->named_parameters()) {
      if (!parameter.value().requires_grad()) continue;
      ASSERT_TRUE(parameter.value().grad().defined()) << parameter.key();
      EXPECT_TRUE(parameter.value().grad().isfinite().all().item<bool>()) << parameter.key();
    }
  }
}

TEST(DeepShading, HasTheAuthorsParametersAndTheyLearn) {
  torch::manual_seed(6);
  DeepShading network;
  int64_t parameters = 0;
  for (const at::Tensor& parameter : network->parameters()) parameters += parameter.numel();
  EXPECT_EQ(parameters, 133'489);
  const at::Tensor x = torch::rand({3, 7, 48, 32}), answer = network->forward(x);
  EXPECT_EQ(answer.sizes(), (std::vector<int64_t>{3, 1, 48, 32}));
  answer.square().mean().backward();
  for (const auto& parameter : network->named_parameters()) {
    ASSERT_TRUE(parameter.value().grad().defined()) << parameter.key();
    EXPECT_GT(parameter.value().grad().abs().max().item<double>(), 0) << parameter.key();
  }
}

TEST(DeepShading, DissimilarityIsThatOfEveryWindow) {
  torch::manual_seed(7);
  const at::Tensor a = torch::rand({2, 1, 11, 9}, torch::kDouble),
                   b = torch::rand({2, 1, 11, 9}, torch::kDouble);
  double sum = 0;
  int windows = 0;
  for (int64_t i = 0; i < 2; ++i) {
    for (int64_t y = 0; y + 8 <= 11; ++y) {
      for (int64_t x = 0; x + 8 <= 9; ++x, ++windows) {
        const at::Tensor p = a[i][0].narrow(0, y, 8).narrow(1, x, 8),
                         q = b[i][0].narrow(0, y, 8).narrow(1, x, 8);
        const double mp = p.mean().item<double>(), mq = q.mean().item<double>();
        const double vp = (p - mp).square().mean().item<double>(),
                     vq = (q - mq).square().mean().item<double>(),
                     c = ((p - mp) * (q - mq)).mean().item<double>();
        sum +=
            (2 * mp * mq + 1e-4) * (2 * c + 1e-3) / ((mp * mp + mq * mq + 1e-4) * (vp + vq + 1e-3));
      }
    }
  }
  EXPECT_NEAR(structural_dissimilarity(a, b).item<double>(), 1 - sum / windows, 1e-10);
  EXPECT_NEAR(structural_dissimilarity(a, a).item<double>(), 0, 1e-12);
}

/// A view of the corner x, y, z >= 0 of a room, from `eye` along -(1, 1, 1) or so.
data::View corner_view(const Vec3& eye, const at::Tensor& rotation, int width, int height) {
  data::View view;
  view.width = width;
  view.height = height;
  for (int i = 0; i < width * height; ++i) {
    const at::Tensor ray = rotation.t().matmul(torch::tensor(
        {(i % width + 0.5) / width - 0.5, ((i / width + 0.5) / height - 0.5) * height / width, 0.8},
        torch::kDouble));
    const double d[3] = {ray[0].item<double>(), ray[1].item<double>(), ray[2].item<double>()};
    double t = 1e9;
    const double from[3] = {eye.x, eye.y, eye.z};
    for (int c = 0; c < 3; ++c) {
      if (d[c] < 0) t = std::min(t, -from[c] / d[c]);
    }
    view.position.push_back({static_cast<float>(from[0] + t * d[0]),
                             static_cast<float>(from[1] + t * d[1]),
                             static_cast<float>(from[2] + t * d[2])});
    view.mask.push_back(t < 1e9 ? 1 : 0);
  }
  return view;
}

TEST(ViewCamera, IsFoundFromWhatThePixelsSee) {
  const auto unit = [](const at::Tensor& v) { return v / v.norm(); };
  const at::Tensor z = unit(torch::tensor({-1.0, -0.7, -1.2}, torch::kDouble)),
                   x = unit(torch::cross(z, torch::tensor({0.0, 1.0, 0.0}, torch::kDouble), 0)),
                   rotation = torch::stack({x, torch::cross(z, x, 0), z});
  const Vec3 eye{3, 2, 3.5f};
  const auto camera = camera_of(corner_view(eye, rotation, 24, 16));
  ASSERT_TRUE(camera.has_value());
  EXPECT_TRUE(torch::allclose(camera->rotation, rotation, 0, 1e-4)) << camera->rotation;
  EXPECT_TRUE(
      torch::allclose(camera->center, torch::tensor({3.0, 2.0, 3.5}, torch::kDouble), 0, 1e-3))
      << camera->center;
  data::View wall = corner_view(eye, rotation, 24, 16);
  for (size_t i = 0; i < wall.mask.size(); ++i) wall.mask[i] = wall.position[i].x < 1e-4f ? 1 : 0;
  EXPECT_FALSE(camera_of(wall).has_value());  // one plane has many cameras
}

TEST(PointConv, IsTheSumOverNeighboursOfAMatrixEach) {
  torch::manual_seed(8);
  PointConv layer(3, 4);
  layer->to(torch::kDouble);
  const int64_t Q = 5, K = 6;
  const Neighbourhood near{torch::randint(7, {Q, K}), torch::randn({Q, K, 3}, torch::kDouble),
                           torch::rand({Q, K, 1}, torch::kDouble)};
  const at::Tensor features = torch::randn({2, 7, 3}, torch::kDouble);
  const auto parameter = [&](const char* name) { return layer->named_parameters()[name]; };
  const auto perceptron = [&](const std::string& name, const at::Tensor& x) {
    const at::Tensor hidden =
        torch::gelu(torch::addmv(parameter((name + ".hidden.bias").c_str()),
                                 parameter((name + ".hidden.weight").c_str()), x));
    return torch::addmv(parameter((name + ".output.bias").c_str()),
                        parameter((name + ".output.weight").c_str()), hidden);
  };
  const at::Tensor answer = layer->forward(features, near);
  const at::Tensor matrices = parameter("output.weight").view({4, 3, 16});
  for (int64_t b = 0; b < 2; ++b) {
    for (int64_t q = 0; q < Q; ++q) {
      at::Tensor sum = parameter("output.bias").clone();
      for (int64_t k = 0; k < K; ++k) {
        const at::Tensor w = perceptron("weight", near.offset[q][k]) *
                             torch::sigmoid(perceptron("scale", near.density[q][k])) /
                             std::sqrt(static_cast<double>(K));
        sum =
            sum + torch::matmul(matrices, w).matmul(features[b][near.index[q][k].item<int64_t>()]);
      }
      const at::Tensor expected = torch::gelu(
          torch::layer_norm(sum, {4}, parameter("norm.weight"), parameter("norm.bias")));
      EXPECT_TRUE(torch::allclose(answer[b][q], expected, 1e-6, 1e-8)) << b << ' ' << q;
    }
  }
}

TEST(PointNetwork, TreatsColorChannelsAlikeAndLearns) {
  torch::manual_seed(9);
  PointNetwork network(0.3);
  nn::PointSet points = nn::synthetic_room(400, 8);
  points.emission = torch::rand({400, 3});
  const nn::QuerySet queries = queries_of(40);
  const at::Tensor answer = network->forward(point_levels(points), queries);
  EXPECT_EQ(answer.sizes(), (std::vector<int64_t>{40, 3}));
  EXPECT_GT(answer.min().item<double>(), 0);
  nn::PointSet turned = points;
  for (at::Tensor* column : {&turned.albedo, &turned.emission, &turned.direct, &turned.direct_back})
    *column = column->roll(1, 1).contiguous();
  EXPECT_TRUE(torch::allclose(answer.roll(1, 1), network->forward(point_levels(turned), queries),
                              1e-4, 1e-6));
  nn::PointSet brighter = points;
  for (at::Tensor* column : {&brighter.emission, &brighter.direct, &brighter.direct_back})
    *column = *column * 8;
  EXPECT_TRUE(
      torch::allclose(answer, network->forward(point_levels(brighter), queries), 1e-4, 1e-6));
  answer.square().mean().backward();
  for (const auto& parameter : network->named_parameters()) {
    ASSERT_TRUE(parameter.value().grad().defined()) << parameter.key();
    EXPECT_GT(parameter.value().grad().abs().max().item<double>(), 0) << parameter.key();
  }
}

TEST(PointDraw, DrawsInProportionToWeightsUpToOne) {
  const std::vector<double> weights = {1, 2, 1, 0, 100, 4, 1, 1};
  std::vector<double> mean(weights.size(), 0), probability;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    Rng rng(1, static_cast<uint64_t>(i));
    const std::vector<size_t> picks = draw_weighted(weights, 4, &rng, &probability);
    EXPECT_NEAR(static_cast<double>(picks.size()), 4, 1);
    for (const size_t pick : picks) mean[pick] += 1.0 / kDraws;
  }
  EXPECT_DOUBLE_EQ(probability[4], 1);  // heavy: always
  EXPECT_DOUBLE_EQ(probability[3], 0);
  EXPECT_NEAR(probability[1], 2 * probability[0], 1e-12);
  for (size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(mean[i], probability[i], 0.03) << i;
  Rng rng(2);
  EXPECT_EQ(draw_weighted(weights, 8, &rng, &probability).size(), 8u);
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
