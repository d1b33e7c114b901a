#include "lte/nn/encoder/transformer_block.h"

#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "lte/nn/encoder/nearest_neighbour_embedding.h"
#include "lte/ops/knn.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

/// A stage of one scene, of which nothing but its patches is known.
StagePlan one_scene(int64_t points, const PatchMap& map) {
  StagePlan stage;
  stage.scenes = {{0, points, {map}}};
  return stage;
}

/// One point at a time, with an explicit softmax over its patch's slots.
at::Tensor naive_attention(const at::Tensor& x, PatchAttention& attention,
                           const std::vector<std::vector<int64_t>>& patches,
                           const at::Tensor& patch_of, int64_t heads) {
  const auto p = attention->named_parameters();
  const int64_t C = x.size(1), width = C / heads;
  const at::Tensor qkv = x.matmul(p["qkv.weight"].t()) + p["qkv.bias"];
  at::Tensor out = torch::zeros_like(x);
  for (int64_t i = 0; i < x.size(0); ++i) {
    const auto& members = patches[static_cast<size_t>(patch_of[i].item<int64_t>())];
    const at::Tensor rows = qkv.index_select(0, torch::tensor(members));
    for (int64_t h = 0; h < heads; ++h) {
      const at::Tensor q = qkv[i].slice(0, h * width, (h + 1) * width);
      const at::Tensor k = rows.slice(1, C + h * width, C + (h + 1) * width);
      const at::Tensor v = rows.slice(1, 2 * C + h * width, 2 * C + (h + 1) * width);
      const at::Tensor w = torch::softmax(k.matmul(q) / std::sqrt(double(width)), 0);
      out[i].slice(0, h * width, (h + 1) * width).copy_(w.matmul(v));
    }
  }
  return out.matmul(p["proj.weight"].t()) + p["proj.bias"];
}

TEST(PatchAttention, MatchesAnExplicitSoftmaxOverEachPatch) {
  const at::NoGradGuard no_grad;
  constexpr int64_t n = 22, K = 8, C = 12, H = 3;
  PatchAttention attention(C, H, 0.0);
  test::randomize(*attention, 5);
  attention->to(at::kDouble);
  attention->eval();
  const at::Tensor x = torch::randn({n, C}, at::kDouble);
  const at::Tensor order = torch::randperm(n);
  const PatchMap map = make_patch_map(order, K);
  // Slots 0..7, 8..15, and 16..21 with the two borrowed from slots 14 and 15.
  std::vector<std::vector<int64_t>> patches(3);
  at::Tensor patch_of = torch::empty({n}, at::kLong);
  for (int64_t slot = 0; slot < n; ++slot) {
    patches[static_cast<size_t>(slot / K)].push_back(order[slot].item<int64_t>());
    patch_of[order[slot].item<int64_t>()] = slot / K;
  }
  for (const int64_t slot : {14, 15}) patches[2].push_back(order[slot].item<int64_t>());
  const at::Tensor expected = naive_attention(x, attention, patches, patch_of, H);
  EXPECT_LT(test::relative_difference(attention->forward(x, one_scene(n, map), 0, K), expected),
            1e-12);

  // A single patch: everyone sees everyone.
  std::vector<std::vector<int64_t>> all(1);
  for (int64_t i = 0; i < n; ++i) all[0].push_back(i);
  const at::Tensor global = naive_attention(x, attention, all, torch::zeros({n}, at::kLong), H);
  EXPECT_LT(test::relative_difference(attention->forward(x, one_scene(n, {}), 0, 1024), global),
            1e-12);
}

// The angles by the formula of docs/model.md, in complex numbers: a pair (a, b) is a + ib.
at::Tensor turned(const at::Tensor& x, const at::Tensor& cells, int64_t width) {
  const int64_t pairs = width / 2, of_axis = pairs / 3;
  at::Tensor out = x.clone();
  for (int64_t i = 0; i < x.size(0); ++i) {
    for (int64_t c = 0; c < x.size(1); c += width) {
      for (int64_t p = 0; p < 3 * of_axis; ++p) {
        const double angle =
            cells[i][p / of_axis].item<double>() * 0.157 * std::pow(2.0, double(p % of_axis));
        const std::complex<double> z(x[i][c + p].item<double>(),
                                     x[i][c + pairs + p].item<double>());
        const std::complex<double> w = z * std::polar(1.0, angle);
        out[i][c + p] = w.real();
        out[i][c + pairs + p] = w.imag();
      }
    }
  }
  return out;
}

TEST(PatchAttention, WithRotaryPositionsIsSoftmaxOverTurnedQueriesAndKeys) {
  const at::NoGradGuard no_grad;
  torch::manual_seed(9);
  ModelConfig config = test::tiny_config();
  config.preset = Preset::Lte;
  config.head_width = 14;  // two angles an axis and a pair that does not turn
  config.channels = 28;
  constexpr int64_t n = 6, C = 28, H = 2;
  const StagePlan stage = make_stages(torch::randint(50, {n, 3}, at::kInt), config, false, {0})[0];
  PatchAttention attention(C, H, 0.0);
  test::randomize(*attention, 5);
  attention->eval();
  const at::Tensor x = torch::randn({n, C});
  const auto p = attention->named_parameters();
  const at::Tensor qkv = (x.matmul(p["qkv.weight"].t()) + p["qkv.bias"]).to(at::kDouble);
  const at::Tensor q = turned(qkv.slice(1, 0, C), stage.cells, config.head_width),
                   k = turned(qkv.slice(1, C, 2 * C), stage.cells, config.head_width);
  at::Tensor out = torch::empty({n, C}, at::kDouble);
  for (int64_t h = 0; h < H; ++h) {
    const auto head = [&](const at::Tensor& t) { return t.slice(1, 14 * h, 14 * (h + 1)); };
    const at::Tensor w = torch::softmax(head(q).matmul(head(k).t()) / std::sqrt(14.0), 1);
    head(out).copy_(w.matmul(head(qkv.slice(1, 2 * C))));
  }
  const at::Tensor expected =
      out.matmul(p["proj.weight"].t().to(at::kDouble)) + p["proj.bias"].to(at::kDouble);
  const auto got = [&] { return attention->forward(x, stage, 0, 1024); };
  EXPECT_LT(test::relative_difference(got(), expected), 1e-5) << "inference";
  const at::AutoGradMode with_gradients(true);
  EXPECT_LT(test::relative_difference(got().detach(), expected), 1e-5) << "training";
}

TEST(PatchAttention, EntropyIsThatOfTheSoftmaxOverLogN) {
  const at::NoGradGuard no_grad;
  torch::manual_seed(10);
  constexpr int64_t n = 20, C = 8, H = 2, K = 8;
  PatchAttention attention(C, H, 0.0);
  const at::Tensor x = torch::randn({n, C});
  auto p = attention->named_parameters();
  const auto entropy = [&](const PatchMap& map) {
    return attention->record(x, one_scene(n, map), 0, K).entropy();
  };
  p["qkv.weight"].zero_();
  EXPECT_NEAR(entropy({}), 1, 1e-6) << "every point alike";
  const PatchMap patches = make_patch_map(torch::randperm(n), K);
  EXPECT_NEAR(entropy(patches), 1, 1e-6);
  p["qkv.weight"].slice(0, 0, 2 * C).copy_(torch::eye(C).repeat({2, 1}) * 300);
  EXPECT_LT(entropy({}), 0.01) << "a product of a vector with itself wins";
  test::randomize(*attention, 3);
  const at::Tensor qkv = x.matmul(p["qkv.weight"].t()) + p["qkv.bias"];
  double sum = 0;
  for (int64_t h = 0; h < H; ++h) {
    const at::Tensor q = qkv.slice(1, 4 * h, 4 * h + 4), k = qkv.slice(1, C + 4 * h, C + 4 * h + 4);
    const at::Tensor w = torch::softmax(q.matmul(k.t()) / 2, 1);
    sum -= (w * w.log()).sum(1).mean().item<double>() / H;
  }
  EXPECT_NEAR(entropy({}), sum / std::log(double(n)), 1e-5);
}

StagePlan some_stage(int64_t n, const ModelConfig& config) {
  torch::manual_seed(8);
  return make_stages(torch::randint(6, {n, 3}, at::kInt), config, false, {0})[0];
}

TEST(TransformerBlock, GradientsMatchFiniteDifferences) {
  ModelConfig config = test::tiny_config();
  config.preset = Preset::Lte;
  const StagePlan stage = some_stage(19, config);  // three patches, some points in one cell
  TransformerBlock block(8, config);
  test::randomize(*block, 7);
  block->to(at::kDouble);
  const at::Tensor x = torch::randn({19, 8}, at::kDouble).requires_grad_();
  const at::Tensor weight = torch::randn({19, 8}, at::kDouble);
  std::vector<at::Tensor> inputs = block->parameters();
  inputs.push_back(x);
  test::expect_gradients_match([&] { return (block->forward(x, stage, 0) * weight).sum(); },
                               inputs);
}

TEST(TransformerBlock, InferenceIsThatOfFloat64ForFewPointsAndForMany) {
  const at::NoGradGuard no_grad;
  ModelConfig config = test::tiny_config();
  config.preset = Preset::Lte;
  for (const int64_t n : {40, 511, 512, 1300}) {
    const StagePlan stage = some_stage(n, config);
    TransformerBlock block(24, config);
    test::randomize(*block, 16);
    block->eval();
    const at::Tensor x = torch::randn({n, 24}), got = block->forward(x, stage, 0);
    block->to(at::kDouble);
    EXPECT_LT(test::relative_difference(got, block->forward(x.to(at::kDouble), stage, 0)), 1e-5)
        << n;
  }
}

TEST(PointNorm, SubtractsItsShareOfWhatPointsHaveInCommon) {
  const at::NoGradGuard no_grad;
  PointNorm centered(6, true), plain(6, false);
  centered->to(at::kDouble);
  plain->to(at::kDouble);
  const at::Tensor x = torch::randn({9, 6}, at::kDouble), common = torch::randn({6}, at::kDouble);
  const auto norm = [](PointNorm& of, const at::Tensor& points) {
    return of->forward(points, one_scene(9, {}));
  };
  const at::Tensor of_x = norm(centered, x);
  EXPECT_LT(test::relative_difference(norm(centered, x + 100 * common), of_x), 1e-11);
  EXPECT_GT(test::relative_difference(norm(plain, x + 100 * common), norm(plain, x)), 0.1);
  EXPECT_LT(test::relative_difference(of_x, norm(plain, x - x.mean(0))), 1e-12);
  centered->named_parameters()["share"].zero_();
  EXPECT_LT(test::relative_difference(norm(centered, x), norm(plain, x)), 1e-12);
}

TEST(PointNorm, OfOnePointIsItsBias) {
  const at::NoGradGuard no_grad;
  PointNorm norm(4, true);
  const at::Tensor bias = torch::randn({4});
  norm->named_parameters()["bias"].copy_(bias);
  EXPECT_TRUE(
      torch::equal(norm->forward(torch::randn({1, 4}), one_scene(1, {})), bias.unsqueeze(0)));
}

TEST(NeighbourMax, IsTheMaximumOverConcatenatedPairs) {
  constexpr int64_t n = 2100, m = 1050, D = 6, k = 5;  // more centres than one block of inference
  NeighbourMax module(D);
  test::randomize(*module, 12);
  module->to(at::kDouble);
  const at::Tensor dense = torch::randn({n, D}, at::kDouble);
  const at::Tensor center = dense.narrow(0, 0, m);
  const at::Tensor index = torch::randint(n, {m, k});
  const auto p = module->named_parameters();
  const at::Tensor x_k = dense.index({index}), x_l = center.unsqueeze(1).expand({m, k, D});
  const at::Tensor pair = torch::cat({x_k - x_l, x_l}, 2);
  const at::Tensor hidden = torch::gelu(torch::linear(pair, p["hidden.weight"], p["hidden.bias"]));
  const at::Tensor expected =
      std::get<0>(torch::linear(hidden, p["output.weight"], p["output.bias"]).max(1));
  EXPECT_LT(test::relative_difference(module->forward(dense, center, index), expected), 1e-12);
  const at::NoGradGuard no_grad;
  EXPECT_LT(test::relative_difference(module->forward(dense, center, index), expected), 1e-12);
}

TEST(NearestNeighbourEmbedding, GradientsMatchFiniteDifferences) {
  torch::manual_seed(13);
  const EncoderPlan plan = make_encoder_plan(torch::rand({21, 3}), test::tiny_config(), false, 0);
  NearestNeighbourEmbedding module(12, 6);
  test::randomize(*module, 14);
  module->to(at::kDouble);
  const at::Tensor x = torch::randn({21, 12}, at::kDouble).requires_grad_();
  const at::Tensor weight = torch::randn({plan.position.size(0), 6}, at::kDouble);
  std::vector<at::Tensor> inputs = module->parameters();
  inputs.push_back(x);
  test::expect_gradients_match([&] { return (module->forward(x, plan) * weight).sum(); }, inputs);
}

TEST(Mlp, DropoutActsWhileTrainingOnly) {
  torch::manual_seed(15);
  Mlp mlp(4, 64, 4, 0.5);
  const at::Tensor x = torch::randn({10, 4});
  EXPECT_FALSE(torch::equal(mlp->forward(x), mlp->forward(x)));
  mlp->eval();
  EXPECT_TRUE(torch::equal(mlp->forward(x), mlp->forward(x)));
}

}  // namespace
}  // namespace lte::nn
