#include "lte/nn/decoder/query_decoder.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>
#include <torch/nn/functional/normalization.h>

#include "tests/nn/reference_decoder.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

struct Case {
  ModelConfig config = test::tiny_config();
  QueryDecoder decoder{nullptr};
  Surface query, anchor;
  at::Tensor attributes, latent;
  double spacing = 0.1;

  Case(int64_t Q, int64_t m, at::ScalarType dtype, Preset preset) {
    config.query_layers = 3;
    config.preset = preset;
    decoder = QueryDecoder(config.channels, config);
    test::randomize(*decoder, 11);
    decoder->to(dtype);
    decoder->eval();
    const auto normals = [](int64_t n) {
      return torch::nn::functional::normalize(torch::randn({n, 3}));
    };
    query = {torch::rand({Q, 3}).to(dtype), normals(Q).to(dtype)};
    attributes = torch::cat({4 * query.position, torch::randn({Q, 6}).to(dtype)}, 1);
    anchor = {torch::rand({m, 3}), normals(m)};
    latent = torch::randn({m, config.channels}).to(dtype).requires_grad_();
  }

  at::Tensor trained() {
    const auto near = decoder->neighbourhood(query, anchor, spacing);
    const auto [keys, values] = decoder->keys_and_values(latent);
    return decoder->forward(attributes, near, keys, values);
  }

  at::Tensor reference() {
    std::map<std::string, at::Tensor> parameters;
    for (const auto& item : decoder->named_parameters()) parameters[item.key()] = item.value();
    const at::ScalarType dtype = query.position.scalar_type();
    return test::reference_decoder(parameters, config, attributes, query,
                                   {anchor.position.to(dtype), anchor.normal.to(dtype)}, latent,
                                   spacing);
  }
};

class QueryDecoderOf : public testing::TestWithParam<Preset> {};

TEST_P(QueryDecoderOf, IsThePairwiseEquationsGradientsIncluded) {
  for (const auto& [dtype, tolerance] :
       {std::pair(at::kFloat, 1e-5), std::pair(at::kDouble, 1e-11)}) {
    for (const int64_t m : {1, 3, 40}) {  // fewer latents than neighbours, and more
      Case c(50, m, dtype, GetParam());
      const at::Tensor got = c.trained(), expected = c.reference();
      EXPECT_LT(test::relative_difference(got, expected), tolerance) << "m = " << m;
      std::vector<at::Tensor> inputs = c.decoder->parameters();
      inputs.push_back(c.latent);
      const at::Tensor weight = torch::randn_like(got);
      const auto a = torch::autograd::grad({(got * weight).sum()}, inputs);
      const auto b = torch::autograd::grad({(expected * weight).sum()}, inputs);
      for (size_t i = 0; i < inputs.size(); ++i) {
        EXPECT_LT((a[i] - b[i]).norm().item<double>(), tolerance * b[i].norm().item<double>())
            << "gradient of input " << i << " " << inputs[i].sizes() << ", m = " << m;
      }
    }
  }
}

TEST_P(QueryDecoderOf, InferenceAgreesWithTraining) {
  Case c(300, 60, at::kFloat, GetParam());
  const at::Tensor expected = c.reference();
  const at::NoGradGuard no_grad;
  const at::Tensor got =
      c.decoder->infer(c.attributes, c.query, c.anchor, c.spacing, c.decoder->table(c.latent));
  EXPECT_LT(test::relative_difference(got, expected), 1e-5);
}

TEST_P(QueryDecoderOf, GradientsMatchFiniteDifferences) {
  Case c(7, 12, at::kDouble, GetParam());
  std::vector<at::Tensor> inputs = {c.latent, c.attributes.requires_grad_()};
  for (const at::Tensor& parameter : c.decoder->parameters()) inputs.push_back(parameter);
  test::expect_gradients_match([&] { return c.trained().square().sum(); }, inputs);
}

INSTANTIATE_TEST_SUITE_P(Presets, QueryDecoderOf, testing::Values(Preset::Paper, Preset::Lte),
                         [](const auto& of) { return enum_name(of.param); });

TEST(QueryDecoder, StartsAtTheTrainingMeanWithPositionsAsStrongAsKeys) {
  torch::manual_seed(3);
  ModelConfig config;
  config.output_mean = 0.37;
  QueryDecoder decoder(config.channels, config);
  decoder->eval();
  const at::NoGradGuard no_grad;
  // A plane sampled with unit spacing, as farthest point sampling leaves it.
  const at::Tensor anchor =
      torch::cartesian_prod({torch::arange(30), torch::arange(30)}).to(at::kFloat);
  const at::Tensor grid = torch::cat({anchor, torch::zeros({900, 1})}, 1).contiguous();
  const at::Tensor query = torch::cat({10 + 10 * torch::rand({200, 2}), torch::zeros({200, 1})}, 1);
  const auto near = decoder->neighbourhood({query, {}}, {grid, {}}, 1.0);
  const at::Tensor latent = torch::randn({900, config.channels});
  const auto [keys, values] = decoder->keys_and_values(latent);
  const double key_std = keys.std().item<double>();
  EXPECT_NEAR(key_std, 1, 0.2);
  const auto parameters = decoder->named_parameters();
  const at::Tensor hidden = torch::gelu(torch::linear(
      near.geometry, parameters["gamma.hidden.weight"], parameters["gamma.hidden.bias"]));
  const at::Tensor P = torch::linear(hidden, parameters["gamma.output.weight"]);
  EXPECT_GT(P.std().item<double>(), 0.5);
  EXPECT_LT(P.std().item<double>(), 2);

  const at::Tensor out = decoder->forward(torch::randn({200, 9}), near, keys, values);
  EXPECT_NEAR(out.mean().item<double>(), 0.37, 0.05);
  EXPECT_GE(out.min().item<double>(), 0);
}

}  // namespace
}  // namespace lte::nn
