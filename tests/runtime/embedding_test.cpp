// One network and its embeddings, from arrays and from tensors.
#include "lte/runtime/embedding.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/nn/cost.h"
#include "lte/nn/files/model_file.h"
#include "lte/radiosity/point_radiosity.h"
#include "lte/runtime/device.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"
#include "tests/nn/support.h"
#include "tests/runtime/spans.h"
#include "tests/support/message_of.h"

namespace lte::runtime {
namespace {

using test::span;

using test::message_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A file of random weights, removed when the network is loaded.
Network tiny_network(const nn::ModelConfig& config = test::tiny_config()) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("lte_runtime_" + std::to_string(::getpid()) + ".safetensors");
  nn::LightTransportModel model(config);
  test::randomize(*model, 5);
  nn::save_model(path, model, {{"scene_points", "300"}, {"scene_points_pruned", "true"}});
  Network network(path);
  std::filesystem::remove(path);
  return network;
}

ScenePoints arrays(const nn::PointSet& p) {
  return {span<Vec3>(p.position),
          span<Vec3>(p.normal),
          span<Rgb>(p.albedo),
          span<Rgb>(p.emission),
          span<float>(p.area),
          {},
          {}};
}

QueryPoints arrays(const nn::QuerySet& q) {
  return {span<Vec3>(q.position), span<Vec3>(q.normal), span<Rgb>(q.albedo)};
}

at::Tensor tensor(const std::vector<Rgb>& values) {
  return at::from_blob(const_cast<Rgb*>(values.data()), {static_cast<int64_t>(values.size()), 3},
                       at::kFloat)
      .clone();
}

TEST(Network, TellsWhatItsFileSays) {
  const Network network = tiny_network();
  EXPECT_EQ(network.metadata().scene_points, 300);
  EXPECT_TRUE(network.metadata().scene_points_pruned);
  EXPECT_EQ(network.config().channels, test::tiny_config().channels);
  EXPECT_EQ(network.parameters(), nn::count_parameters(TorchParts::model(network)).total);
  EXPECT_TRUE(network.device().is_cpu());
  EXPECT_THROW(Network("/nonexistent/none.safetensors"), Error);
  EXPECT_THROW(cuda_device(100), NoDevice);
}

TEST(Network, AsksForTheLightThatItsModelReads) {
  nn::ModelConfig config = test::tiny_config();
  EXPECT_EQ(tiny_network(config).light_request().depth, 0);
  config.light_input = nn::LightInput::Traced;
  EXPECT_EQ(tiny_network(config).light_request().depth, 5);
  EXPECT_EQ(tiny_network(config).light_request().paths, 32);
  config.light_input = nn::LightInput::Radiosity;
  EXPECT_EQ(tiny_network(config).light_request().depth, 0) << "which it has solved";
}

TEST(SceneEmbedding, SolvesTheLightOfModelsThatReadRadiosity) {
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Radiosity;
  const Network network = tiny_network(config);
  const nn::PointSet points = nn::in_canonical_order(test::box_scene(300, 1));
  const ScenePoints scene = arrays(points);
  const radiosity::PointIrradiance light =
      radiosity::solve({scene.position, scene.normal, scene.albedo, scene.emission, scene.area}, 1);
  std::vector<Rgb> indirect = light.indirect;
  ASSERT_GT(tensor(indirect).sum().item<double>(), 0);
  ScenePoints given = scene;
  given.direct = light.direct;
  given.indirect = indirect;
  given.direct_back = light.direct_back;
  given.indirect_back = light.indirect_back;
  const nn::QuerySet queries = test::box_queries(50, 2);
  const std::vector<Rgb> answers = SceneEmbedding(network, scene).decode(arrays(queries));
  EXPECT_EQ(answers, SceneEmbedding(network, given).decode(arrays(queries)));
  for (Rgb& value : indirect) value *= 2;
  EXPECT_NE(answers, SceneEmbedding(network, given).decode(arrays(queries)))
      << "light that is given is read";
}

TEST(SceneEmbedding, ArraysAndTensorsGiveTheModelsAnswers) {
  const Network network = tiny_network();
  const nn::PointSet points = test::box_scene(300, 1);
  const nn::QuerySet queries = test::box_queries(500, 2);
  const at::NoGradGuard no_grad;
  const at::Tensor expected = TorchParts::model(network)->decode(
      TorchParts::model(network)->encode(nn::in_canonical_order(points)), queries);
  const SceneEmbedding embedding(network, arrays(points));
  EXPECT_TRUE(test::same(tensor(embedding.decode(arrays(queries))), expected));
  const SceneEmbedding same = TorchParts::encode(network, points);
  EXPECT_TRUE(test::same(TorchParts::decode(same, queries, {}), expected));
  EXPECT_TRUE(embedding.decode({}).empty());
  EXPECT_EQ(embedding.info().scene_points, 300);
  EXPECT_EQ(embedding.info().scale, network.config().scale);
  EXPECT_DOUBLE_EQ(embedding.mean_emission(), nn::mean_emission(points));
  EXPECT_DOUBLE_EQ(mean_emission(arrays(points)), nn::mean_emission(points));
}

TEST(SceneEmbedding, DoesNotDependOnTheOrderOfThePoints) {
  for (const nn::LightInput light : {nn::LightInput::Emission, nn::LightInput::Radiosity}) {
    nn::ModelConfig config = test::tiny_config();
    config.light_input = light;
    const Network network = tiny_network(config);
    nn::PointSet points = test::box_scene(300, 1);
    points.position.select(0, 7).copy_(points.position.select(0, 4));  // two sides of a sheet, say
    points.normal.select(0, 7).copy_(points.normal.select(0, 4) * -1);
    const nn::QuerySet queries = test::box_queries(50, 2);
    const at::Tensor expected =
        TorchParts::decode(TorchParts::encode(network, points), queries, {});
    for (const int seed : {1, 2, 3}) {
      std::vector<int64_t> numbers(300);
      std::iota(numbers.begin(), numbers.end(), 0);
      std::shuffle(numbers.begin(), numbers.end(), std::mt19937(static_cast<unsigned>(seed)));
      const at::Tensor order = at::tensor(numbers, at::kLong);
      nn::PointSet shuffled = points;
      for (at::Tensor* t : shuffled.tensors())
        if (t->defined()) *t = t->index_select(0, order);
      ASSERT_FALSE(test::same(shuffled.position, points.position));
      EXPECT_TRUE(test::same(TorchParts::decode(TorchParts::encode(network, shuffled), queries, {}),
                             expected));
    }
  }
}

TEST(SceneEmbedding, NamesABadRowAsTheCallerHasIt) {
  const Network network = tiny_network();
  nn::PointSet points = test::box_scene(300, 1);
  points.normal.select(0, 241).select(0, 1).fill_(NAN);
  EXPECT_THAT(message_of([&] { SceneEmbedding(network, arrays(points)); }),
              HasSubstr("normal of row 241 is not finite"));
}

TEST(SceneEmbedding, DoesNotDependOnTheBlock) {
  const Network network = tiny_network();
  const SceneEmbedding embedding = TorchParts::encode(network, test::box_scene(300, 1));
  const nn::QuerySet queries = test::box_queries(500, 2);
  const at::Tensor whole = TorchParts::decode(embedding, queries, {});
  for (const int64_t block : {37, 499, 500}) {
    EXPECT_LT(
        test::relative_difference(TorchParts::decode(embedding, queries, {true, block}), whole),
        1e-5);
  }
}

/// Models with and without light at their points, and with a radiance decoder.
std::vector<nn::ModelConfig> kinds() {
  nn::ModelConfig plain = test::tiny_config(), radiosity = plain, radiance = plain;
  radiosity.light_input = radiance.light_input = nn::LightInput::Radiosity;
  radiance.radiance_lobes = 4;
  return {plain, radiosity, radiance};
}

TEST(SceneEmbedding, WhatIsMadeOnceChangesNoBit) {
  for (const nn::ModelConfig& config : kinds()) {
    const Network network = tiny_network(config);
    const nn::PointSet points = test::box_scene(300, 31);
    const nn::QuerySet queries = test::box_queries(90, 32);
    const SceneEmbedding embedding(network, arrays(points));
    nn::Embedding parts = TorchParts::embedding(embedding);
    EXPECT_TRUE(parts.nearest && parts.weights);
    EXPECT_EQ(parts.prior.nearest != nullptr, config.reads_light());
    parts.nearest = parts.prior.nearest = nullptr;
    parts.weights = parts.radiance_weights = nullptr;
    const SceneEmbedding bare = TorchParts::from(network, parts, 300, {});
    for (const int64_t count : {1, 7, 90}) {
      const nn::QuerySet some = {queries.position.narrow(0, 0, count),
                                 queries.normal.narrow(0, 0, count),
                                 queries.albedo.narrow(0, 0, count)};
      EXPECT_EQ(embedding.decode(arrays(some)), bare.decode(arrays(some)));
      if (config.predicts_radiance()) {
        EXPECT_EQ(embedding.decode_radiance(arrays(some), arrays(some).normal),
                  bare.decode_radiance(arrays(some), arrays(some).normal));
      }
    }
  }
}

TEST(SceneEmbedding, ThreadsGetTheAnswersOfOne) {
  for (const nn::ModelConfig& config : kinds()) {
    const nn::PointSet points = test::box_scene(300, 33);
    const nn::QuerySet queries = test::box_queries(64, 34);
    const SceneEmbedding embedding(tiny_network(config), arrays(points));
    const QueryPoints all = arrays(queries);
    const auto one_by_one = [&] {
      std::vector<Rgb> out;
      for (size_t i = 0; i < 64; ++i) {
        const QueryPoints one{all.position.subspan(i, 1), all.normal.subspan(i, 1),
                              all.albedo.subspan(i, 1)};
        out.push_back(embedding.decode(one).front());
      }
      return out;
    };
    const std::vector<Rgb> expected = one_by_one();
    std::vector<std::vector<Rgb>> found(4);
    {
      std::vector<std::jthread> threads;
      for (std::vector<Rgb>& mine : found) threads.emplace_back([&] { mine = one_by_one(); });
    }
    for (const std::vector<Rgb>& mine : found) EXPECT_EQ(mine, expected);
  }
}

TEST(SceneEmbedding, IsLinearInEmission) {
  const Network network = tiny_network();
  nn::PointSet points = test::box_scene(300, 1);
  const nn::QuerySet queries = test::box_queries(200, 2);
  SceneEmbedding embedding(network, arrays(points));
  const at::Tensor before = tensor(embedding.decode(arrays(queries)));
  points.emission = points.emission * 64;
  const SceneEmbedding brighter(network, arrays(points));
  const at::Tensor after = tensor(brighter.decode(arrays(queries)));
  EXPECT_LT(test::relative_difference(after, before * 64), 1e-4);
  embedding.set_emission_gain({64, 64, 64});
  EXPECT_TRUE(test::same(tensor(embedding.decode(arrays(queries))), before * 64));
  EXPECT_DOUBLE_EQ(embedding.mean_emission(), 64 * nn::mean_emission(test::box_scene(300, 1)));
}

TEST(SceneEmbedding, ASceneTooLargeIsRefusedOrShrunk) {
  const Network network = tiny_network();
  nn::PointSet points = test::box_scene(300, 1);
  nn::QuerySet queries = test::box_queries(60, 2);
  for (at::Tensor* p : {&points.position, &queries.position}) *p = (*p * 8).contiguous();
  try {
    SceneEmbedding(network, arrays(points));
    FAIL() << "a scene of 40 m went into a model of 16 m";
  } catch (const SceneTooLarge& refusal) {
    EXPECT_STREQ(refusal.what(),
                 "the scene spans 40 m, the model knows scenes up to 16 m: set rescale to shrink "
                 "it for the network");
    EXPECT_THAT(refusal.hints(), testing::ElementsAre(Hint::Rescale));
  }
  const SceneEmbedding shrunk(network, arrays(points), {.rescale = true});
  const double scale = shrunk.info().scale;
  EXPECT_NEAR(scale, 40, 1e-3);
  const at::NoGradGuard no_grad;
  const nn::Embedding expected =
      TorchParts::model(network)->encode(nn::in_canonical_order(points), 0, {{}, scale});
  EXPECT_TRUE(test::same(tensor(shrunk.decode(arrays(queries))),
                         TorchParts::model(network)->decode(expected, queries)));
  EXPECT_NO_THROW(network.check_fits(40, true));
  EXPECT_NO_THROW(network.check_fits(16, false));
  EXPECT_NO_THROW(network.check_fits(16.000002, false)) << "points beyond the wall by rounding";
  EXPECT_THROW(network.check_fits(16.1, false), SceneTooLarge);
}

/// box_scene() is 5 m wide; powers of two scale it without rounding.
TEST(SceneEmbedding, AScaleModelOfARoomIsEnlargedToTheLeastThatIsKnown) {
  const Network network = tiny_network();
  EXPECT_EQ(network.least_extent(), 4);
  const auto answers_of = [&](float factor, bool rescale, double* scale) {
    nn::PointSet points = test::box_scene(300, 1);
    nn::QuerySet queries = test::box_queries(60, 2);
    for (at::Tensor* p : {&points.position, &queries.position}) *p = (*p * factor).contiguous();
    points.area = points.area * (factor * factor);
    const SceneEmbedding embedding(network, arrays(points), {.rescale = rescale});
    *scale = embedding.info().scale;
    return tensor(embedding.decode(arrays(queries)));
  };
  double scale = 0, smaller = 0;
  const at::Tensor tiny = answers_of(0.125f, true, &scale);
  EXPECT_NEAR(scale, 16 * 0.625 / 4, 1e-3);
  EXPECT_LT(test::relative_difference(answers_of(0.03125f, true, &smaller), tiny), 1e-4);
  EXPECT_NEAR(smaller, scale / 4, 1e-3);
  EXPECT_GT(test::relative_difference(answers_of(0.125f, false, &scale), tiny), 1e-3);
  EXPECT_EQ(scale, 16) << "as it is, unless asked for";
  EXPECT_TRUE(test::same(answers_of(1, true, &scale), answers_of(1, false, &smaller)));
}

TEST(SceneEmbedding, AGivenLeastCornerKeepsNetworkSpaceInPlace) {
  const Network network = tiny_network();
  const nn::PointSet points = test::box_scene(300, 1);
  const SceneEmbedding embedding(network, arrays(points), {.origin = Vec3{-0.5f, -0.25f, -1}});
  EXPECT_THAT(embedding.info().origin, testing::ElementsAre(-0.5, -0.25, -1));
}

TEST(SceneEmbedding, KeepsToItsMemoryLimit) {
  const Network network = tiny_network();
  const nn::PointSet points = test::box_scene(300, 1);
  EXPECT_THROW(SceneEmbedding(network, arrays(points), {.memory = MemoryLimit(2)}),
               NotEnoughMemory);
}

TEST(SceneEmbedding, RefusesWhatItCannotDoInOneLine) {
  const Network network = tiny_network();
  nn::PointSet points = test::box_scene(300, 1);
  ScenePoints short_areas = arrays(points);
  short_areas.area = short_areas.area.first(3);
  EXPECT_THAT(message_of([&] { SceneEmbedding(network, short_areas); }), HasSubstr("3 areas"));
  EXPECT_THAT(message_of([&] { SceneEmbedding(network, ScenePoints{}); }),
              HasSubstr("at least one"));
  const SceneEmbedding embedding(network, arrays(points));
  const nn::QuerySet queries = test::box_queries(20, 2);
  QueryPoints short_normals = arrays(queries);
  short_normals.normal = short_normals.normal.first(3);
  EXPECT_THAT(message_of([&] { embedding.decode(short_normals); }), HasSubstr("3 normals"));
  queries.position.select(0, 11).select(0, 0).fill_(NAN);
  EXPECT_THAT(message_of([&] { embedding.decode(arrays(queries)); }), HasSubstr("row 11"));
  points.position.select(0, 17).select(0, 1).fill_(NAN);
  EXPECT_THAT(message_of([&] { SceneEmbedding(network, arrays(points)); }),
              AllOf(HasSubstr("row 17"), Not(HasSubstr("\n"))));
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Traced;
  EXPECT_THAT(
      message_of([&] { SceneEmbedding(tiny_network(config), arrays(test::box_scene(9, 1))); }),
      HasSubstr("direct irradiance is missing"));
  config.light_input = nn::LightInput::Radiosity;
  EXPECT_THAT(message_of([&] { SceneEmbedding(tiny_network(config), arrays(points)); }),
              HasSubstr("row 17"));
}

}  // namespace
}  // namespace lte::runtime
