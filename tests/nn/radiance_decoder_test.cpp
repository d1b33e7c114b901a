#include "lte/nn/decoder/radiance_decoder.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <torch/nn/functional/normalization.h>

#include "lte/base/safetensors.h"
#include "lte/nn/cost.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/points/surfels.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"

namespace lte::nn {
namespace {

ModelConfig radiance_config() {
  ModelConfig config = test::tiny_geometric_config();
  config.light_input = LightInput::Radiosity;
  config.radiance_lobes = 6;
  return config;
}

/// N unit directions of each query, above its surface.
at::Tensor directions_above(const QuerySet& queries, int64_t N, uint64_t seed) {
  torch::manual_seed(seed);
  const at::Tensor random = torch::randn({queries.position.size(0), N, 3}).to(queries.normal);
  const at::Tensor unit = torch::nn::functional::normalize(
      random, torch::nn::functional::NormalizeFuncOptions().dim(2));
  const at::Tensor normal = queries.normal.unsqueeze(1);
  const at::Tensor cosine = (unit * normal).sum(2, true);
  return unit - 2 * cosine.clamp_max(0) * normal;
}

PointSet with_metal(PointSet points) {
  torch::manual_seed(9);
  points.gloss = torch::rand({points.position.size(0), 2});
  return points;
}

struct RadianceCase {
  LightTransportModel model{nullptr};
  PointSet points = with_metal(test::box_scene(150, 1));
  QuerySet queries = test::box_queries(40, 2);
  at::Tensor directions = directions_above(queries, 7, 3);

  explicit RadianceCase(const ModelConfig& config = radiance_config()) : model(config) {
    test::randomize(*model, 4);
    model->eval();
  }
  at::Tensor radiance() {
    const at::NoGradGuard no_grad;
    return model->decode_radiance(model->encode(points), queries, directions);
  }
};

double gelu(double x) { return x * 0.5 * std::erfc(-x / std::sqrt(2.0)); }

TEST(RadianceDecoder, MixesTheLobesOfItsFeaturesWithWhatRaysSee) {
  const ModelConfig config = radiance_config();
  const int64_t D = config.channels, K = config.radiance_lobes, Q = 5, N = 3;
  RadianceDecoder decoder(D, config);
  test::randomize(*decoder, 11);
  decoder->to(at::kDouble);
  torch::manual_seed(1);
  const at::Tensor features = torch::rand({Q, D}, at::kDouble);
  const at::Tensor directions = torch::randn({Q, N, 3}, at::kDouble),
                   light = torch::rand({Q, 3}, at::kDouble),
                   seen = torch::rand({Q, N, kSeenColumns}, at::kDouble);
  const at::NoGradGuard no_grad;
  const at::Tensor got = decoder->radiance(features, directions, light, seen);
  const auto p = decoder->named_parameters();
  const auto dense = [&](const std::string& name, const std::vector<double>& x) {
    const at::Tensor weight = p[name + ".weight"], bias = p[name + ".bias"];
    std::vector<double> y;
    for (int64_t o = 0; o < weight.size(0); ++o) {
      double sum = bias[o].item<double>();
      for (size_t i = 0; i < x.size(); ++i)
        sum += weight[o][static_cast<int64_t>(i)].item<double>() * x[i];
      y.push_back(sum);
    }
    return y;
  };
  for (int64_t q = 0; q < Q; ++q) {
    std::vector<double> f;
    for (int64_t d = 0; d < D; ++d) f.push_back(features[q][d].item<double>());
    const std::vector<double> own = dense("lobes", f);
    for (int64_t n = 0; n < N; ++n) {
      std::vector<double> lobes, mixed;
      for (int64_t k = 0; k < K; ++k) {
        double sum = own[static_cast<size_t>(3 * K + k)];
        for (int64_t axis = 0; axis < 3; ++axis)
          sum += own[static_cast<size_t>(3 * k + axis)] * directions[q][n][axis].item<double>();
        lobes.push_back(gelu(sum));
      }
      for (int64_t column = 0; column < kSeenFeatures; ++column)
        lobes.push_back(seen[q][n][kSeenLog + column].item<double>());
      const std::vector<double> mixtures = dense("mix", lobes);
      for (int64_t k = 0; k < K; ++k)
        mixed.push_back(
            gelu(mixtures[static_cast<size_t>(k)] + own[static_cast<size_t>(4 * K + k)]));
      const std::vector<double> color = dense("color", mixed);
      const auto factor = [&](int64_t o) {
        return std::log1p(std::exp(color[static_cast<size_t>(o)]));
      };
      for (int64_t c = 0; c < 3; ++c)
        EXPECT_NEAR(got[q][n][c].item<double>(),
                    factor(c) * light[q][c].item<double>() +
                        factor(3 + c) * seen[q][n][kSeenRadiance + c].item<double>(),
                    1e-11);
    }
  }
}

TEST(RadianceDecoder, GradientsMatchFiniteDifferences) {
  LightTransportModel model(radiance_config());
  test::randomize(*model, 6);
  model->to(at::kDouble);
  model->eval();
  const PointSet points = test::as_double(with_metal(test::box_scene(60, 1)));
  const QuerySet queries = test::as_double(test::box_queries(6, 2));
  const at::Tensor directions = directions_above(queries, 4, 3);
  // The encoder's parameters are not among them: the light that rays see comes from it, and rays
  // are not differentiated.
  std::vector<at::Tensor> inputs;
  for (const auto& item : model->named_parameters()) {
    if (item.key().starts_with("radiance.")) inputs.push_back(item.value());
  }
  test::expect_gradients_match(
      [&] {
        const Embedding embedding = model->encode(points);
        return model
            ->decode_radiance_normalized({{embedding}, embedding.features}, {queries},
                                         {directions})[0]
            .square()
            .sum();
      },
      inputs, 1e-5);
}

TEST(RadianceDecoder, InferenceAgreesWithTrainingInBlocksOfAnySize) {
  RadianceCase c;
  const Embedding embedding = c.model->encode(c.points);
  ASSERT_FALSE(embedding.table.defined()) << "with gradients there are no tables";
  const at::Tensor trained = c.model
                                 ->decode_radiance_normalized({{embedding}, embedding.features},
                                                              {c.queries}, {c.directions})[0]
                                 .detach() *
                             (embedding.emission_scale / std::numbers::pi).to(at::kFloat);
  EXPECT_LT(test::relative_difference(c.radiance(), trained), 1e-5);
  const at::NoGradGuard no_grad;
  const at::Tensor blocks =
      c.model->decode_radiance(c.model->encode(c.points), c.queries, c.directions, {.block = 7});
  EXPECT_LT(test::relative_difference(blocks, trained), 1e-5);
}

TEST(RadianceDecoder, AFreshModelAnswersMostlyWhatRaysSee) {
  torch::manual_seed(5);
  LightTransportModel model(radiance_config());
  model->eval();
  const RadianceCase c;
  const at::NoGradGuard no_grad;
  const Embedding embedding = model->encode(c.points);
  const at::Tensor answer = model->decode_radiance_normalized({{embedding}, embedding.features},
                                                              {c.queries}, {c.directions})[0];
  const at::Tensor place = (c.queries.position - embedding.origin) / embedding.scale;
  const at::Tensor seen = embedding.surfels.see(place, c.directions);
  const at::Tensor light = embedding.prior.read(place, c.queries.normal).irradiance.unsqueeze(1);
  EXPECT_GT(seen.select(2, kSeenHit).mean().item<double>(), 0.03);
  EXPECT_LT(test::relative_difference(answer, 0.8 * seen.narrow(2, 0, 3) + 0.2 * light), 0.1);
}

TEST(RadianceDecoder, ScalesWithTheLight) {
  RadianceCase c;
  const at::Tensor before = c.radiance();
  // All light doubled: every input over the emission scale stays, so the answer is exactly twice.
  for (at::Tensor* t : {&c.points.emission, &c.points.direct, &c.points.indirect,
                        &c.points.direct_back, &c.points.indirect_back})
    *t = *t * 2;
  EXPECT_LT(test::relative_difference(c.radiance(), 2 * before), 1e-6);
}

TEST(RadianceDecoder, WithoutEmissionThereIsNoRadiance) {
  RadianceCase c;
  c.points.emission = torch::zeros_like(c.points.emission);
  EXPECT_EQ(c.radiance().abs().max().item<float>(), 0);
}

TEST(RadianceDecoder, ReadsTheGlossOfScenePoints) {
  RadianceCase c;
  const at::Tensor metal = c.radiance();
  at::Tensor rough = c.points.gloss.clone();
  rough.select(1, 0).zero_();
  c.points.gloss = rough;
  const at::Tensor none = c.radiance();
  EXPECT_GT(test::relative_difference(none, metal), 1e-5);
  c.points.gloss = at::Tensor();
  EXPECT_TRUE(torch::equal(c.radiance(), none))
      << "what is no metal reads the same at any roughness";
  c.points.gloss = rough.clone();
  c.points.gloss[7][1] = 1.5;
  test::expect_error([&] { c.radiance(); }, {"gloss", "row 7", "outside [0, 1]"});
}

TEST(RadianceDecoder, RefusesWhatItCannotAnswer) {
  RadianceCase c;
  c.directions[3][2] = 2 * c.directions[3][2];
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "unit"});
  c.directions[3][2] = -c.queries.normal[3];
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "into the surface"});
  c.directions[3][2] = torch::full({3}, NAN);
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "unit"});
  c.directions = torch::zeros({40, 3});
  test::expect_error([&] { c.radiance(); }, {"[40, N, 3]"});
  RadianceCase without(test::tiny_config());
  without.directions = directions_above(without.queries, 2, 1);
  test::expect_error([&] { without.radiance(); }, {"no radiance decoder", "radiance_lobes"});
}

TEST(RadianceDecoder, IsInTheModelFile) {
  const test::TempDir folder;
  RadianceCase c;
  save_model(folder / "m.safetensors", c.model);
  const at::Tensor before = c.radiance();
  c.model = load_model(folder / "m.safetensors");
  EXPECT_EQ(c.model->config().radiance_lobes, 6);
  EXPECT_TRUE(torch::equal(c.radiance(), before));
}

TEST(RadianceDecoder, ItsParametersAreCountedApart) {
  const ParameterCounts counts = count_parameters(RadianceCase().model);
  EXPECT_EQ(counts.nne + counts.encoder + counts.decoder + counts.radiance, counts.total);
}

}  // namespace
}  // namespace lte::nn
