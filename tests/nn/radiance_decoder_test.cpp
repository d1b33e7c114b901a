#include "lte/nn/radiance_decoder.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <torch/nn/functional/normalization.h>

#include "lte/base/safetensors.h"
#include "lte/nn/constants.h"
#include "lte/nn/cost.h"
#include "lte/nn/model_file.h"
#include "tests/nn/reference_decoder.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"

namespace lte::nn {
namespace {

ModelConfig radiance_config() {
  ModelConfig config = test::tiny_geometric_config();
  config.radiance_lobes = 6;
  config.gloss = true;
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

struct Case {
  LightTransportModel model{nullptr};
  PointSet points = with_metal(test::box_scene(150, 1));
  QuerySet queries = test::box_queries(40, 2);
  at::Tensor directions = directions_above(queries, 7, 3);

  explicit Case(ModelConfig config = radiance_config()) : model(config) {
    test::randomize(*model, 4);
    model->eval();
  }
  at::Tensor radiance() {
    const at::NoGradGuard no_grad;
    return model->decode_radiance(model->encode(points), queries, directions);
  }
};

double gelu(double x) { return x * 0.5 * std::erfc(-x / std::sqrt(2.0)); }

TEST(RadianceDecoder, IsTheLobesOfItsFeaturesDirectionByDirection) {
  const ModelConfig config = radiance_config();
  const int64_t D = config.channels, K = config.radiance_lobes, Q = 5, N = 3;
  RadianceDecoder decoder(D, config);
  test::randomize(*decoder, 11);
  decoder->to(at::kDouble);
  torch::manual_seed(1);
  const at::Tensor features = torch::rand({Q, D}, at::kDouble);
  const at::Tensor directions = torch::randn({Q, N, 3}, at::kDouble);
  const at::NoGradGuard no_grad;
  const at::Tensor got = decoder->radiance(features, directions);
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
      const std::vector<double> mixtures = dense("mix", lobes);
      for (int64_t k = 0; k < K; ++k)
        mixed.push_back(
            gelu(mixtures[static_cast<size_t>(k)] + own[static_cast<size_t>(4 * K + k)]));
      const std::vector<double> color = dense("color", mixed);
      for (int64_t c = 0; c < 3; ++c)
        EXPECT_NEAR(got[q][n][c].item<double>(),
                    std::log1p(std::exp(color[static_cast<size_t>(c)])), 1e-12);
    }
  }
}

TEST(RadianceDecoder, GaussiansAreTheirSum) {
  ModelConfig config = radiance_config();
  config.radiance_head = RadianceHead::Gaussians;
  config.radiance_lobes = 3;
  const int64_t D = config.channels, K = 3, Q = 4, N = 5;
  RadianceDecoder decoder(D, config);
  test::randomize(*decoder, 11);
  decoder->to(at::kDouble);
  torch::manual_seed(1);
  const at::Tensor features = torch::rand({Q, D}, at::kDouble);
  const at::Tensor directions = torch::nn::functional::normalize(
      torch::randn({Q, N, 3}, at::kDouble), torch::nn::functional::NormalizeFuncOptions().dim(2));
  const at::NoGradGuard no_grad;
  const at::Tensor got = decoder->radiance(features, directions);
  const auto p = decoder->named_parameters();
  const at::Tensor own = features.matmul(p["gaussians.weight"].t()) + p["gaussians.bias"];
  const auto number = [&](int64_t q, int64_t column) { return own[q][column].item<double>(); };
  const auto softplus = [](double x) { return std::log1p(std::exp(x)); };
  for (int64_t q = 0; q < Q; ++q) {
    for (int64_t n = 0; n < N; ++n) {
      double sum[3] = {};
      for (int64_t k = 0; k < K; ++k) {
        double along = 0, squares = 0;
        for (int64_t axis = 0; axis < 3; ++axis) {
          const double a = number(q, 3 * k + axis);
          along += a * directions[q][n][axis].item<double>();
          squares += a * a;
        }
        const double value =
            std::exp(softplus(number(q, 3 * K + k)) * (along / std::sqrt(squares) - 1));
        for (int64_t c = 0; c < 3; ++c) sum[c] += softplus(number(q, 4 * K + 3 * k + c)) * value;
      }
      for (int64_t c = 0; c < 3; ++c) EXPECT_NEAR(got[q][n][c].item<double>(), sum[c], 1e-10);
    }
  }
}

TEST(RadianceDecoder, AnOctahedralMapHasACellForEveryDirection) {
  const auto cell = [](float x, float y, float z, int64_t edge) {
    return octahedral_cells(torch::tensor({x, y, z}).view({1, 1, 3}), edge).item<int64_t>();
  };
  // The upper half is the square on its corner in the middle; the lower folds into the corners.
  EXPECT_EQ(cell(0.1f, 0.1f, 0.9f, 4), 10);
  EXPECT_EQ(cell(-0.1f, 0.1f, 0.9f, 4), 9);
  EXPECT_EQ(cell(0.1f, -0.1f, 0.9f, 4), 6);
  EXPECT_EQ(cell(0.1f, 0.1f, -0.9f, 4), 15);
  EXPECT_EQ(cell(-0.1f, -0.1f, -0.9f, 4), 0);
  torch::manual_seed(2);
  const at::Tensor all = octahedral_cells(torch::randn({1, 20000, 3}), 8);
  const at::Tensor found = at::bincount(all.view({-1}), {}, 64);
  EXPECT_EQ(found.size(0), 64);
  EXPECT_GT(found.min().item<int64_t>(), 100) << "cells differ in solid angle by a factor of five";
}

/// The early head, alone or with rays among the points.
ModelConfig early_config(RadianceBase base) {
  ModelConfig config = radiance_config();
  config.radiance_head = RadianceHead::Early;
  config.light_input = LightInput::Traced;
  config.radiance_base = base;
  return config;
}

/// A model of each head; the last two cast rays.
std::vector<ModelConfig> all_kinds() {
  ModelConfig map = radiance_config(), gaussians = map, casts = map;
  map.radiance_head = RadianceHead::Map;
  gaussians.radiance_head = RadianceHead::Gaussians;
  casts.light_input = LightInput::Traced;
  casts.radiance_base = RadianceBase::Points;
  return {radiance_config(),
          map,
          gaussians,
          early_config(RadianceBase::Irradiance),
          early_config(RadianceBase::Points),
          casts};
}

/// A model of random weights in float64, and what it is asked.
struct DoubleCase {
  LightTransportModel model;
  PointSet points;
  QuerySet queries;
  at::Tensor directions;  ///< [queries, ways, 3]
};

DoubleCase double_case(const ModelConfig& config, int64_t queries, int64_t ways) {
  DoubleCase out{LightTransportModel(config),
                 test::as_double(with_metal(test::box_scene(60, 1))),
                 test::as_double(test::box_queries(queries, 2)),
                 {}};
  out.directions = directions_above(out.queries, ways, 3);
  test::randomize(*out.model, 6);
  out.model->to(at::kDouble);
  out.model->eval();
  return out;
}

TEST(RadianceDecoder, AnEarlyDirectionIsAQueryOfItsOwn) {
  for (const RadianceBase base : {RadianceBase::Irradiance, RadianceBase::Points}) {
    const ModelConfig config = early_config(base);
    SCOPED_TRACE(config.to_yaml());
    auto [model, points, queries, directions] = double_case(config, 5, 3);
    const at::NoGradGuard no_grad;
    const Embedding embedding = model->encode(points);
    const at::Tensor got = model->decode_radiance_normalized({{embedding}, embedding.features},
                                                             {queries}, {directions})[0];
    std::map<std::string, at::Tensor> parameters;
    const std::string prefix = "radiance.query.";
    for (const auto& item : model->named_parameters()) {
      if (item.key().starts_with("radiance."))
        parameters[item.key().substr(prefix.size())] = item.value();
    }
    EXPECT_EQ(parameters.at("point.hidden.weight").size(1),
              9 + kLightFeatures + 3 + (config.casts_rays() ? kSeenFeatures : 0));
    const at::Tensor place = (queries.position - embedding.origin) / embedding.scale;
    const LightReading reading = embedding.cache.read(place, queries.normal);
    const Surface latents{embedding.position.to(at::kDouble), embedding.normal.to(at::kDouble)};
    for (int64_t q = 0; q < directions.size(0); ++q) {
      const auto row = [q](const at::Tensor& of) { return of.narrow(0, q, 1); };
      for (int64_t n = 0; n < directions.size(1); ++n) {
        const at::Tensor way = row(directions).select(1, n);
        std::vector<at::Tensor> columns = {kPositionGain * row(place), row(queries.normal),
                                           row(queries.albedo), row(reading.features), way};
        at::Tensor seen;
        if (config.casts_rays()) {
          seen = embedding.surfels.see(row(place), way.unsqueeze(1)).select(1, 0);
          columns.push_back(seen.narrow(1, 3, kSeenFeatures));
        }
        const at::Tensor factors = test::reference_decoder(
            parameters, config, torch::cat(columns, 1), {row(place), row(queries.normal)}, latents,
            embedding.features, embedding.spacing);
        at::Tensor expected = factors.narrow(1, 0, 3) * row(reading.irradiance);
        if (seen.defined()) expected = expected + factors.narrow(1, 3, 3) * seen.narrow(1, 0, 3);
        EXPECT_LT(test::relative_difference(row(got).select(1, n), expected), 1e-9);
      }
    }
  }
}

TEST(RadianceDecoder, GradientsMatchFiniteDifferences) {
  for (const ModelConfig& config : all_kinds()) {
    SCOPED_TRACE(config.to_yaml());
    auto [model, points, queries, directions] = double_case(config, 6, 4);
    std::vector<at::Tensor> inputs;
    for (const auto& item : model->named_parameters()) {
      if (item.key().starts_with("radiance.")) inputs.push_back(item.value());
    }
    // The first layer sees gloss; through it all of the encoder is differentiated. Rays are not,
    // and the light that they see is of the encoder too.
    if (!config.casts_rays())
      inputs.push_back(model->named_parameters()["nne.point.hidden.weight"]);
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
}

TEST(RadianceDecoder, InferenceAgreesWithTrainingInBlocksOfAnySize) {
  for (const ModelConfig& config : all_kinds()) {
    SCOPED_TRACE(config.to_yaml());
    Case c(config);
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
}

TEST(RadianceDecoder, AFreshModelThatCastsRaysSaysMostlyWhatTheySee) {
  for (const ModelConfig& config : all_kinds()) {
    if (!config.casts_rays()) continue;
    SCOPED_TRACE(config.to_yaml());
    torch::manual_seed(5);
    LightTransportModel model(config);
    model->eval();
    const Case c(config);
    const at::NoGradGuard no_grad;
    const Embedding embedding = model->encode(c.points);
    const at::Tensor answer = model->decode_radiance_normalized({{embedding}, embedding.features},
                                                                {c.queries}, {c.directions})[0];
    const at::Tensor place = (c.queries.position - embedding.origin) / embedding.scale;
    const at::Tensor seen = embedding.surfels.see(place, c.directions);
    const at::Tensor light = embedding.cache.read(place, c.queries.normal).irradiance.unsqueeze(1);
    EXPECT_GT(seen.select(2, kSeenHit).mean().item<double>(), 0.03);
    EXPECT_LT(test::relative_difference(answer, 0.8 * seen.narrow(2, 0, 3) + 0.2 * light), 0.1);
  }
}

TEST(RadianceDecoder, IsAFactorOnTheLightThatPointsAreTold) {
  ModelConfig config = radiance_config();
  config.light_input = LightInput::Traced;
  config.light_sides = LightSides::Apart;
  Case c(config);
  const at::Tensor before = c.radiance();
  // All light doubled: every input over the emission scale stays, so the answer is exactly twice.
  for (at::Tensor* t : {&c.points.emission, &c.points.direct, &c.points.indirect,
                        &c.points.direct_back, &c.points.indirect_back})
    *t = *t * 2;
  EXPECT_LT(test::relative_difference(c.radiance(), 2 * before), 1e-6);
  // Fresh networks answer with the light itself: π L is the irradiance of the estimates.
  torch::manual_seed(3);
  config.output_mean = 1;
  LightTransportModel fresh(config);
  fresh->eval();
  const at::NoGradGuard no_grad;
  const Embedding embedding = fresh->encode(c.points);
  const at::Tensor radiance = fresh->decode_radiance(embedding, c.queries, c.directions);
  const at::Tensor irradiance = fresh->decode(embedding, c.queries);
  EXPECT_LT(test::relative_difference(std::numbers::pi * radiance,
                                      irradiance.unsqueeze(1).expand_as(radiance)),
            0.1);
}

TEST(RadianceDecoder, WithoutEmissionThereIsNoRadiance) {
  Case c;
  c.points.emission = torch::zeros_like(c.points.emission);
  EXPECT_EQ(c.radiance().abs().max().item<float>(), 0);
}

TEST(RadianceDecoder, PointsTellOfMetalToModelsThatReadIt) {
  Case c;
  const at::Tensor metal = c.radiance();
  at::Tensor rough = c.points.gloss.clone();
  rough.select(1, 0).zero_();
  c.points.gloss = rough;
  const at::Tensor none = c.radiance();
  EXPECT_GT(test::relative_difference(none, metal), 1e-5);
  c.points.gloss = at::Tensor();
  EXPECT_TRUE(torch::equal(c.radiance(), none))
      << "what is no metal reads the same at any roughness";
  ModelConfig blind = radiance_config();
  blind.gloss = false;
  Case other(blind);
  const at::Tensor with = other.radiance();
  other.points.gloss = at::Tensor();
  EXPECT_TRUE(torch::equal(other.radiance(), with));
  c.points.gloss = rough.clone();
  c.points.gloss[7][1] = 1.5;
  test::expect_error([&] { c.radiance(); }, {"gloss", "row 7", "outside [0, 1]"});
}

TEST(RadianceDecoder, RefusesWhatItCannotAnswer) {
  Case c;
  c.directions[3][2] = 2 * c.directions[3][2];
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "unit"});
  c.directions[3][2] = -c.queries.normal[3];
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "into the surface"});
  c.directions[3][2] = torch::full({3}, NAN);
  test::expect_error([&] { c.radiance(); }, {"direction 2 of query 3", "unit"});
  c.directions = torch::zeros({40, 3});
  test::expect_error([&] { c.radiance(); }, {"[40, N, 3]"});
  Case without(test::tiny_config());
  without.directions = directions_above(without.queries, 2, 1);
  test::expect_error([&] { without.radiance(); }, {"no radiance decoder", "radiance_lobes"});
}

TEST(RadianceDecoder, IsInTheModelFile) {
  const test::TempDir folder;
  Case c;
  save_model(folder / "m.safetensors", c.model);
  const at::Tensor before = c.radiance();
  c.model = load_model(folder / "m.safetensors");
  EXPECT_EQ(c.model->config().radiance_lobes, 6);
  EXPECT_TRUE(c.model->config().gloss);
  EXPECT_TRUE(torch::equal(c.radiance(), before));
}

TEST(RadianceDecoder, AFurtherDirectionCostsAFewHundredthsOfAPoint) {
  ModelConfig config;  // as configs/train/lte_radiance.yaml has it
  config.channels = 48;
  config.query_neighbours = 16;
  config.query_layers = 4;
  config.light_input = LightInput::Radiosity;
  config.pair_geometry = PairGeometry::Normals;
  config.radiance_lobes = 48;
  EXPECT_LT(direction_flops(config, 1024), 0.05 * radiance_flops(config, 1024));
  const ParameterCounts counts = count_parameters(Case().model);
  EXPECT_EQ(counts.nne + counts.encoder + counts.decoder + counts.radiance, counts.total);
}

TEST(RadianceDecoder, AnEarlyDirectionCostsAsMuchAsAnIrradianceQueryAndItsColumns) {
  const ModelConfig config = early_config(RadianceBase::Points);
  const int64_t D = config.channels;
  EXPECT_EQ(radiance_flops(config, 20), 0);
  EXPECT_EQ(direction_flops(config, 20),
            decode_flops(config, 20) + static_cast<double>(2 * D * (3 + kSeenFeatures + 3)));
  const ParameterCounts counts = count_parameters(Case(config).model);
  EXPECT_EQ(counts.radiance, counts.decoder + D * (3 + kSeenFeatures) + 3 * D + 3);
}

TEST(RadianceDecoder, WhatReadsPositionsIsNeverRounded) {
  // 9 + 12 + 1 + 3 + 7 inputs: a number that products in bfloat16 could take.
  ModelConfig config = early_config(RadianceBase::Points);
  config.light_sides = LightSides::Apart;
  config.light_variance = true;
  RadianceDecoder decoder(config.channels, config);
  set_precision(*decoder, Precision::Bf16);
  for (const auto& module : decoder->named_modules()) {
    if (module.key() == "query.point.hidden") {
      const LinearImpl& hidden = *module.value()->as<LinearImpl>();
      EXPECT_EQ(hidden.options.in_features(), 32);
      const at::NoGradGuard no_grad;
      EXPECT_FALSE(hidden.in_bf16());
    }
    if (module.key() == "query.point.output") {
      const at::NoGradGuard no_grad;
      EXPECT_TRUE(module.value()->as<LinearImpl>()->in_bf16());
    }
  }
}

}  // namespace
}  // namespace lte::nn
