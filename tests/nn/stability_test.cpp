// float32 inference against float64 equations, on embeddings and scenes chosen to hurt.
#include <gtest/gtest.h>

#include "lte/nn/query_decoder.h"
#include "lte/ops/neighbour_sums.h"

#include "reference_decoder.h"
#include "support.h"

namespace lte::nn {
namespace {

struct Adversary {
  const char* name;
  std::function<void(at::Tensor& latent, at::Tensor& anchor, at::Tensor& position,
                     QueryDecoder& decoder)>
      arrange;
  double bound;  ///< of the error, in the Euclidean norm, over that of the answer
};

/// Inference in float32 against the pairwise equations in float64, same weights.
double decoder_error(const Adversary& adversary, int64_t channels) {
  const at::NoGradGuard no_grad;
  ModelConfig config = test::tiny_config();
  config.channels = channels;
  config.query_neighbours = 32;
  config.query_layers = 6;
  torch::manual_seed(31);
  QueryDecoder decoder(channels, config);
  decoder->eval();
  at::Tensor position = torch::rand({70, 3}), anchor = torch::rand({100, 3}),
             latent = torch::randn({100, channels});
  adversary.arrange(latent, anchor, position, decoder);
  const at::Tensor attributes = torch::cat({4 * position, torch::randn({70, 6})}, 1);
  const auto [keys, values] = decoder->keys_and_values(latent);
  const at::Tensor got =
      decoder->infer(attributes, position, anchor, 0.1, ops::neighbour_table(keys, values));
  EXPECT_TRUE(got.isfinite().all().item<bool>()) << adversary.name;
  std::map<std::string, at::Tensor> exact;
  for (const auto& item : decoder->named_parameters())
    exact[item.key()] = item.value().to(at::kDouble);
  const at::Tensor expected =
      test::reference_decoder(exact, config, attributes.to(at::kDouble), position.to(at::kDouble),
                              anchor.to(at::kDouble), latent.to(at::kDouble), 0.1);
  return test::relative_difference(got.to(at::kDouble), expected);
}

TEST(Stability, DecodingInFloat32StaysNearFloat64OnAdversarialEmbeddings) {
  const auto nothing = [](at::Tensor&, at::Tensor&, at::Tensor&, QueryDecoder&) {};
  const std::vector<Adversary> adversaries = {
      {"random", nothing, 2e-6},
      {"one latent ten thousand times the others",
       [](at::Tensor& latent, at::Tensor&, at::Tensor&, QueryDecoder&) { latent[7].mul_(1e4); },
       1e-5},
      {"all latents ten thousand times as large",
       [](at::Tensor& latent, at::Tensor&, at::Tensor&, QueryDecoder&) { latent.mul_(1e4); }, 1e-5},
      {"coincident points, as many as neighbours",
       [](at::Tensor&, at::Tensor& anchor, at::Tensor& position, QueryDecoder&) {
         anchor.narrow(0, 0, 32).copy_(anchor[0].clone());
         position.narrow(0, 0, 20).copy_(anchor[0].clone());
         // Elsewhere no query may be as far from the 32nd neighbour as from the 33rd.
         position.narrow(0, 20, 50).copy_(anchor[0] + 1e-3 * torch::randn({50, 3}));
       },
       2e-6},
      {"zero-variance latents",
       [](at::Tensor& latent, at::Tensor&, at::Tensor&, QueryDecoder&) { latent.fill_(3); }, 2e-6},
      {"zero-variance query features",
       [](at::Tensor&, at::Tensor&, at::Tensor&, QueryDecoder& decoder) {
         auto parameters = decoder->named_parameters();
         parameters["point.output.weight"].zero_();
         parameters["point.output.bias"].fill_(0.7);
       },
       1e-4},  // rounding of 0.7 over the norm's floor, the root of 1e-5
  };
  for (const int64_t channels : {16, 128}) {
    for (const Adversary& adversary : adversaries) {
      const double error = decoder_error(adversary, channels);
      EXPECT_LT(error, adversary.bound) << adversary.name << ", " << channels << " channels";
    }
  }
}

TEST(Stability, EncodingInFloat32StaysNearFloat64) {
  const at::NoGradGuard no_grad;
  torch::manual_seed(32);
  LightTransportModel model(test::tiny_config());
  model->eval();
  LightTransportModel exact(test::tiny_config());
  const auto weights = model->named_parameters();
  for (auto& item : exact->named_parameters()) item.value().copy_(weights[item.key()]);
  exact->to(at::kDouble);
  exact->eval();
  const auto expect_near = [&](const char* name, const PointSet& points, double bound) {
    const at::Tensor got = model->encode(points).features;
    const at::Tensor expected = exact->encode(test::as_double(points)).features;
    EXPECT_TRUE(got.isfinite().all().item<bool>()) << name;
    EXPECT_LT(test::relative_difference(got.to(at::kDouble), expected), bound) << name;
  };
  const PointSet points = test::box_scene(400, 33);
  expect_near("random", points, 1e-5);
  PointSet bright = points;
  bright.emission = points.emission.clone();
  bright.emission[5].fill_(1e6f);
  expect_near("one lamp a million times the others", bright, 1e-5);
  PointSet coincident = points;
  coincident.position = points.position.clone();
  coincident.position.narrow(0, 0, 64).copy_(points.position[0].clone());
  expect_near("coincident points, twice as many as neighbours", coincident, 1e-5);
  PointSet constant = points;
  constant.normal = torch::zeros_like(points.normal);
  constant.albedo = torch::zeros_like(points.albedo);
  constant.emission = torch::zeros_like(points.emission);
  expect_near("no features but positions", constant, 1e-5);
}

}  // namespace
}  // namespace lte::nn
