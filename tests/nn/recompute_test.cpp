#include "lte/nn/blocks/recompute.h"

#include <map>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>

#include "lte/nn/constants.h"
#include "lte/nn/decoder/query_decoder.h"
#include "lte/nn/encoder/nearest_neighbour_embedding.h"
#include "lte/nn/model.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

TEST(Recompute, GivesTheResultsAndGradientsOfAPlainCall) {
  Mlp mlp(5, 7, 3);
  mlp->to(at::kDouble);
  const at::Tensor x = torch::randn({11, 5}, at::kDouble).requires_grad_(),
                   shift = torch::randn({3}, at::kDouble).requires_grad_(),
                   constant = torch::randn({11, 5}, at::kDouble);
  int calls = 0;
  const TensorFunction function = [&](const std::vector<at::Tensor>& in) {
    ++calls;
    return std::vector<at::Tensor>{mlp->forward(in[0] * in[2]) + in[1], in[0].square()};
  };
  std::vector<at::Tensor> wanted = mlp->parameters();
  wanted.insert(wanted.end(), {x, shift});
  const auto loss = [](const std::vector<at::Tensor>& out) {
    return (out[0].sin()).sum() + (out[1] * 0.3).sum();
  };
  const std::vector<at::Tensor> plain = function({x, shift, constant});
  const auto expected = torch::autograd::grad({loss(plain)}, wanted);
  calls = 0;
  const std::vector<at::Tensor> out = recompute(function, {x, shift, constant}, mlp->parameters());
  EXPECT_EQ(calls, 1);
  for (size_t i = 0; i < out.size(); ++i) EXPECT_TRUE(at::equal(out[i], plain[i]));
  const auto found = torch::autograd::grad({loss(out)}, wanted);
  EXPECT_EQ(calls, 2);
  for (size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_LT(test::relative_difference(found[i], expected[i]), 1e-14) << i;
  }
}

TEST(Recompute, LeavesOutWhatNeedsNoGradient) {
  const at::Tensor x = torch::ones({4}), y = torch::ones({4}).requires_grad_();
  const TensorFunction function = [](const std::vector<at::Tensor>& in) {
    return std::vector<at::Tensor>{in[0] * in[1], in[0] + 1};
  };
  const auto out = recompute(function, {x, y}, {});
  out[0].sum().backward();  // the second result leads to no parameter, and is not asked for
  EXPECT_FALSE(x.grad().defined());
  EXPECT_TRUE(at::equal(y.grad(), x));
  const at::NoGradGuard no_grad;
  EXPECT_FALSE(recompute(function, {x, y}, {})[0].requires_grad());
}

/// The gradients of each layer together, all of it flattened, by the layer's name.
std::map<std::string, at::Tensor> by_layer(const std::vector<std::string>& names,
                                           const std::vector<at::Tensor>& gradients) {
  std::map<std::string, at::Tensor> layers;
  for (size_t i = 0; i < gradients.size(); ++i) {
    const at::Tensor flat = gradients[i].flatten();
    at::Tensor& layer = layers[names[i].substr(0, names[i].rfind('.'))];
    layer = layer.defined() ? at::cat({layer, flat}) : flat;
  }
  return layers;
}

class RecomputedQueries : public testing::TestWithParam<Precision> {};

TEST_P(RecomputedQueries, ManyHaveTheGradientsOfFewAtATime) {
  ModelConfig config = test::tiny_config();
  config.query_neighbours = 32;
  QueryDecoder decoder(config.channels, config);
  test::randomize(*decoder, 12);
  set_autocast(*decoder, GetParam());
  const int64_t rows = rows_of_a_block(32 * std::max(kGammaHidden, config.channels), at::kCPU);
  const int64_t Q = 2 * rows + 7;
  const at::Tensor position = torch::rand({Q, 3}), anchor = torch::rand({50, 3}),
                   attributes = torch::randn({Q, 9}), weight = torch::randn({Q, 3}),
                   latent = torch::randn({50, config.channels}).requires_grad_();
  std::vector<at::Tensor> wanted = {latent};
  std::vector<std::string> names = {"latent"};
  for (const auto& item : decoder->named_parameters()) {
    wanted.push_back(item.value());
    names.push_back(item.key());
  }
  // In either way the table is made once: gradients by keys and values are rounded when they are
  // whole.
  const auto [keys, values] = decoder->keys_and_values(latent);
  const auto part = [&, k = keys, v = values](int64_t begin, int64_t count) {
    const auto near =
        decoder->neighbourhood({position.narrow(0, begin, count), {}}, {anchor, {}}, 0.1);
    const at::Tensor out = decoder->forward(attributes.narrow(0, begin, count), near, k, v);
    return (out * weight.narrow(0, begin, count)).sum();
  };
  const auto whole = torch::autograd::grad({part(0, Q)}, wanted, {}, /*retain_graph=*/true);
  at::Tensor sum = torch::zeros({});
  for (int64_t begin = 0; begin < Q; begin += rows)
    sum = sum + part(begin, std::min(rows, Q - begin));
  const auto parts = torch::autograd::grad({sum}, wanted);
  // Sums in another order may round to the other bfloat16. Blocks whose first run is not rounded as
  // the second one is would differ by 7e-3.
  const double tolerance = GetParam() == Precision::Bf16 ? 1e-3 : 1e-5;
  const auto layers = by_layer(names, whole), layers_of_parts = by_layer(names, parts);
  for (const auto& [name, gradient] : layers) {
    EXPECT_LT(test::relative_difference(gradient, layers_of_parts.at(name)), tolerance) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Precisions, RecomputedQueries,
                         testing::Values(Precision::Fp32, Precision::Bf16));

TEST(Recompute, ManyPointsHaveTheGradientsOfFewAtATime) {
  const int64_t D = 64, k = 32, rows = rows_of_a_block(k * D, at::kCPU), m = rows + 5;
  NeighbourMax maximum(D);
  const at::Tensor dense = torch::randn({100, D}).requires_grad_(),
                   center = torch::randn({m, D}).requires_grad_(),
                   neighbour = torch::randint(100, {m, k}, at::kLong),
                   weight = torch::randn({m, D});
  std::vector<at::Tensor> wanted = maximum->parameters();
  wanted.insert(wanted.end(), {dense, center});
  const auto part = [&](int64_t begin, int64_t count) {
    return (maximum->forward(dense, center.narrow(0, begin, count),
                             neighbour.narrow(0, begin, count)) *
            weight.narrow(0, begin, count))
        .sum();
  };
  const auto whole = torch::autograd::grad({part(0, m)}, wanted);
  const auto parts = torch::autograd::grad({part(0, rows) + part(rows, m - rows)}, wanted);
  for (size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_LT(test::relative_difference(whole[i], parts[i]), 1e-5) << i;
  }
}

}  // namespace
}  // namespace lte::nn
