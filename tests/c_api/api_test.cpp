// What the C functions compute: the C++ network's answers, in whatever layout, from any thread.
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <ATen/ATen.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/c_api.h"
#include "lte/nn/cost.h"
#include "lte/nn/model_file.h"
#include "tests/c_api/support.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"
#include "tests/support/worker_sleeps.h"

namespace lte {
namespace {

using test::box_queries;
using test::box_scene;
using test::c_points;
using test::c_queries;

/// What the C++ model from the same file answers.
at::Tensor expected(const nn::PointSet& points, const nn::QuerySet& queries) {
  const at::NoGradGuard no_grad;
  nn::LightTransportModel model = nn::load_model(test::tiny_model_file());
  return model->decode(model->encode(points), queries);
}

TEST(CApi, TellsTheModelsProperties) {
  const test::Model model;
  lte_model_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_model_get_info(model.handle, &info), LTE_OK);
  EXPECT_EQ(info.channels, 16);
  EXPECT_EQ(info.query_neighbours, 5);
  EXPECT_EQ(info.scene_points, 300);
  EXPECT_EQ(info.scene_points_pruned, 1);
  EXPECT_EQ(info.suns, 1);
  EXPECT_EQ(info.target, LTE_TARGET_INDIRECT);
  EXPECT_EQ(info.scale, 16);
  EXPECT_EQ(info.device, LTE_DEVICE_CPU);
  EXPECT_EQ(info.light_input, LTE_LIGHT_EMISSION);
  const nn::LightTransportModel loaded = nn::load_model(test::tiny_model_file());
  EXPECT_EQ(info.parameters, nn::count_parameters(loaded).total);
  EXPECT_EQ(lte_abi_version(), uint32_t{LTE_C_API_VERSION});
  EXPECT_STREQ(lte_version_string(), "0.1.0");
}

TEST(CApi, AnswersAreTheCppNetworks) {
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(500, 2);
  const test::Model model;
  const test::Embedding embedding(model.handle, c_points(points));
  EXPECT_TRUE(
      at::equal(test::decode(embedding.handle, c_queries(queries)), expected(points, queries)));
  lte_embedding_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_embedding_get_info(embedding.handle, &info), LTE_OK);
  EXPECT_EQ(info.scene_points, 300);
  EXPECT_EQ(info.latents, 75);
  EXPECT_EQ(info.scale, 16);
  EXPECT_GE(info.bytes, 75 * 16 * 4);
  const at::Tensor radiance = nn::emission_scale(points);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(info.origin[i], points.position.select(1, i).min().item<double>());
    EXPECT_DOUBLE_EQ(info.radiance[i], radiance[i].item<double>());
  }
}

TEST(CApi, AnEmbeddingIsSavedAndReadBack) {
  const test::TempDir folder;
  const std::string path = (folder / "scene.safetensors").string();
  const nn::QuerySet queries = box_queries(500, 2);
  const test::Model model;
  const test::Embedding made(model.handle, c_points(box_scene(300, 1)));
  ASSERT_EQ(lte_embedding_save(made.handle, path.c_str(), "kitchen"), LTE_OK) << lte_last_error();
  lte_embedding* read = nullptr;
  ASSERT_EQ(lte_embedding_load(model.handle, path.c_str(), "kitchen", &read), LTE_OK)
      << lte_last_error();
  EXPECT_TRUE(at::equal(test::decode(read, c_queries(queries)),
                        test::decode(made.handle, c_queries(queries))));
  lte_embedding_release(read);

  const auto refused = [&](const char* file, const char* scene, lte_status status) {
    lte_embedding* other = made.handle;
    EXPECT_EQ(lte_embedding_load(model.handle, file, scene, &other), status);
    EXPECT_EQ(other, nullptr);
    return std::string(lte_last_error());
  };
  EXPECT_THAT(refused(path.c_str(), "hall", LTE_ERROR_FILE), testing::HasSubstr("another scene"));
  EXPECT_THAT(refused(path.c_str(), nullptr, LTE_ERROR_FILE), testing::HasSubstr("kitchen"));
  EXPECT_THAT(refused("/nonexistent/none", "kitchen", LTE_ERROR_FILE), testing::HasSubstr("none"));
  EXPECT_THAT(refused(nullptr, "kitchen", LTE_ERROR_INVALID_ARGUMENT), testing::HasSubstr("path"));
  EXPECT_EQ(lte_embedding_save(made.handle, "/nonexistent/x", nullptr), LTE_ERROR_FILE);
  EXPECT_EQ(lte_embedding_save(nullptr, path.c_str(), nullptr), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(lte_embedding_save(made.handle, path.c_str(), "\xff"), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(lte_embedding_save(made.handle, path.c_str(), std::string(1001, 'x').c_str()),
            LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(lte_embedding_load(nullptr, path.c_str(), "kitchen", &read),
            LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(lte_embedding_load(model.handle, path.c_str(), "kitchen", nullptr),
            LTE_ERROR_INVALID_ARGUMENT);
}

TEST(CApi, AModelThatReadsLightSaysSoAndIsGivenIt) {
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Traced;
  nn::LightTransportModel model(config);
  test::randomize(*model, 5);
  model->eval();
  const std::filesystem::path file = test::tiny_model_file().string() + ".traced";
  nn::save_model(file, model);
  lte_model* handle = nullptr;
  ASSERT_EQ(lte_model_open(file.c_str(), nullptr, &handle), LTE_OK) << lte_last_error();
  std::filesystem::remove(file);
  lte_model_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_model_get_info(handle, &info), LTE_OK);
  EXPECT_EQ(info.light_input, LTE_LIGHT_TRACED);
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(50, 2);
  {
    const at::NoGradGuard no_grad;
    const test::Embedding embedding(handle, c_points(points, /*light=*/true));
    EXPECT_TRUE(at::equal(test::decode(embedding.handle, c_queries(queries)),
                          model->decode(model->encode(points), queries)));
  }
  const lte_scene_points dark = c_points(points);
  lte_embedding* embedding = nullptr;
  EXPECT_NE(lte_model_encode(handle, &dark, &embedding), LTE_OK);
  EXPECT_THAT(lte_last_error(), testing::HasSubstr("direct irradiance is missing"));
  lte_model_release(handle);
}

TEST(CApi, AModelThatReadsSidesAndErrorsIsGivenThem) {
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Traced;
  config.light_sides = nn::LightSides::Apart;
  config.light_variance = true;
  nn::LightTransportModel model(config);
  test::randomize(*model, 5);
  model->eval();
  const std::filesystem::path file = test::tiny_model_file().string() + ".apart";
  nn::save_model(file, model, {{"light_paths", "16"}, {"light_depth", "3"}});
  lte_model* handle = nullptr;
  ASSERT_EQ(lte_model_open(file.c_str(), nullptr, &handle), LTE_OK) << lte_last_error();
  std::filesystem::remove(file);
  lte_model_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_model_get_info(handle, &info), LTE_OK);
  EXPECT_EQ(info.light_sides, LTE_SIDES_APART);
  EXPECT_EQ(info.light_variance, 1);
  EXPECT_EQ(info.light_paths, 16);
  EXPECT_EQ(info.light_depth, 3);
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(50, 2);
  {
    const at::NoGradGuard no_grad;
    const test::Embedding embedding(handle, c_points(points, /*light=*/true));
    EXPECT_TRUE(at::equal(test::decode(embedding.handle, c_queries(queries)),
                          model->decode(model->encode(points), queries)));
  }
  lte_embedding* embedding = nullptr;
  const auto refused = [&](const lte_scene_points& scene, const char* words) {
    EXPECT_NE(lte_model_encode(handle, &scene, &embedding), LTE_OK);
    EXPECT_THAT(lte_last_error(), testing::HasSubstr(words));
  };
  lte_scene_points scene = c_points(points, /*light=*/true);
  scene.indirect_error = nullptr;
  refused(scene, "standard error of indirect irradiance is missing");
  scene.struct_size = offsetof(lte_scene_points, direct_back);  // of an older program
  refused(scene, "direct irradiance of the back is missing");
  lte_model_release(handle);
}

TEST(CApi, ReadsAndWritesInterleavedArrays) {
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(200, 2);
  const test::Model model;
  const at::Tensor all =
      at::cat({points.albedo, points.emission, points.position, points.normal}, 1);
  lte_scene_points scene = c_points(points);
  scene.albedo = {all.const_data_ptr<float>(), 48};
  scene.emission = {all.const_data_ptr<float>() + 3, 48};
  scene.position = {all.const_data_ptr<float>() + 6, 48};
  scene.normal = {all.const_data_ptr<float>() + 9, 48};
  const test::Embedding embedding(model.handle, scene);

  const at::Tensor gap = at::full({200, 1}, std::numeric_limits<float>::quiet_NaN());
  const at::Tensor pixels =
      at::cat({gap, queries.position, gap, queries.normal, queries.albedo}, 1).contiguous();
  lte_queries q = c_queries(queries);
  q.position = {pixels.const_data_ptr<float>() + 1, 44};
  q.normal = {pixels.const_data_ptr<float>() + 5, 44};
  q.albedo = {pixels.const_data_ptr<float>() + 8, 44};
  at::Tensor out = at::full({200, 5}, 7.0f);
  ASSERT_EQ(lte_embedding_decode(embedding.handle, &q, out.data_ptr<float>() + 1, 20), LTE_OK)
      << lte_last_error();
  EXPECT_TRUE(at::equal(out.narrow(1, 1, 3), expected(points, queries)));
  EXPECT_TRUE(at::equal(out.select(1, 0), at::full({200}, 7.0f)));
  EXPECT_TRUE(at::equal(out.select(1, 4), at::full({200}, 7.0f)));
}

TEST(CApi, WithoutAreasAllPointsCountTheSame) {
  nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(50, 2);
  const test::Model model;
  lte_scene_points scene = c_points(points);
  scene.area = nullptr;
  const test::Embedding embedding(model.handle, scene);
  points.area = at::full({300}, 0.25f);
  EXPECT_LT(test::relative_difference(test::decode(embedding.handle, c_queries(queries)),
                                      expected(points, queries)),
            1e-6);
}

TEST(CApi, MaskedQueriesAreNeitherReadNorAnsweredOtherThanZero) {
  const nn::PointSet points = box_scene(300, 1);
  nn::QuerySet queries = box_queries(90, 2);
  const at::Tensor full = expected(points, queries);
  const at::Tensor mask = at::arange(90).remainder(3).ne(0);
  for (at::Tensor* t : {&queries.position, &queries.normal, &queries.albedo}) {
    t->masked_fill_(mask.logical_not().unsqueeze(1), std::numeric_limits<double>::quiet_NaN());
  }
  const at::Tensor bytes = mask.to(at::kByte).mul(200).repeat_interleave(2);
  const test::Model model;
  const test::Embedding embedding(model.handle, c_points(points));
  lte_queries q = c_queries(queries);
  q.mask = bytes.const_data_ptr<uint8_t>();
  q.mask_stride = 2;
  const at::Tensor keep = mask.unsqueeze(1);
  for (const uint32_t flags : {0u, LTE_QUERIES_TRUSTED}) {
    q.flags = flags;
    EXPECT_TRUE(at::equal(test::decode(embedding.handle, q), at::where(keep, full, 0)));
  }
  q.flags = 0;
  const std::vector<uint8_t> none(90, 0);
  q.mask = none.data();
  q.mask_stride = 1;
  EXPECT_TRUE(at::equal(test::decode(embedding.handle, q), at::zeros({90, 3})));
  q.mask = nullptr;
  float out[3 * 90];
  EXPECT_EQ(lte_embedding_decode(embedding.handle, &q, out, 0), LTE_ERROR_INVALID_ARGUMENT);
  queries.albedo[4][1] = 20;  // seen by the mask: named by its own row
  q.mask = bytes.const_data_ptr<uint8_t>();
  q.mask_stride = 2;
  EXPECT_EQ(lte_embedding_decode(embedding.handle, &q, out, 0), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lte_last_error()).find("albedo of row 4"), std::string::npos);
}

TEST(CApi, EmissionGainIsTheEncodingOfScaledEmission) {
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(60, 2);
  const test::Model model;
  const test::Embedding embedding(model.handle, c_points(points));
  const lte_queries q = c_queries(queries);
  const float doubled[3] = {2, 0.5f, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, doubled), LTE_OK);
  const at::Tensor gain = at::tensor({2.0f, 0.5f, 0.0f});
  EXPECT_TRUE(at::equal(test::decode(embedding.handle, q), expected(points, queries) * gain));
  nn::PointSet brighter = points;
  brighter.emission = points.emission * at::tensor({3.0f, 0.7f, 1.0f});
  const float tint[3] = {3, 0.7f, 1};  // over the first emission, not over the doubled
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, tint), LTE_OK);
  EXPECT_LT(
      test::relative_difference(test::decode(embedding.handle, q), expected(brighter, queries)),
      1e-6);
  const float none[3] = {0, 0, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, none), LTE_OK);
  EXPECT_TRUE(at::equal(test::decode(embedding.handle, q), at::zeros({60, 3})));
}

TEST(CApi, ASceneTooLargeIsRefusedOrShrunk) {
  nn::PointSet points = box_scene(300, 1);
  nn::QuerySet queries = box_queries(60, 2);
  const test::Model model;
  for (at::Tensor* p : {&points.position, &queries.position}) *p = (*p * 8).contiguous();
  lte_scene_points scene = c_points(points);
  lte_embedding* refused = nullptr;
  EXPECT_EQ(lte_model_encode(model.handle, &scene, &refused), LTE_ERROR_SCENE_TOO_LARGE);
  EXPECT_EQ(refused, nullptr);
  EXPECT_STREQ(lte_last_error(),
               "scene points: the scene spans 40 m, the model knows scenes up to 16 m: set rescale "
               "to shrink it for the network");
  scene.rescale = 1;
  const test::Embedding embedding(model.handle, scene);
  const at::Tensor got = test::decode(embedding.handle, c_queries(queries));
  lte_embedding_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_embedding_get_info(embedding.handle, &info), LTE_OK);
  EXPECT_NEAR(info.scale, 40, 1e-3);
  const at::NoGradGuard no_grad;
  nn::LightTransportModel cpp = nn::load_model(test::tiny_model_file());
  EXPECT_TRUE(at::equal(got, cpp->decode(cpp->encode(points, 0, {{}, info.scale}), queries)));
  // As a scene that was made that small; ties between lattice points break otherwise.
  for (at::Tensor* p : {&points.position, &queries.position}) *p = (*p * 0.4).contiguous();
  EXPECT_LT(test::relative_difference(got, expected(points, queries)), 0.02);
}

TEST(CApi, AGivenLeastCornerKeepsNetworkSpaceInPlace) {
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(60, 2);
  const test::Model model;
  lte_scene_points scene = c_points(points);
  const float corner[3] = {-0.5f, -0.25f, -1};
  scene.origin = corner;
  const test::Embedding embedding(model.handle, scene);
  lte_embedding_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_embedding_get_info(embedding.handle, &info), LTE_OK);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(info.origin[i], corner[i]);
  const at::NoGradGuard no_grad;
  nn::LightTransportModel cpp = nn::load_model(test::tiny_model_file());
  const nn::Embedding encoded = cpp->encode(points, 0, {at::tensor({-0.5f, -0.25f, -1.0f}), 0});
  const at::Tensor got = test::decode(embedding.handle, c_queries(queries));
  EXPECT_TRUE(at::equal(got, cpp->decode(encoded, queries)));
  EXPECT_FALSE(at::equal(got, expected(points, queries)));
  const float above[3] = {0.5f, 0, 0};
  scene.origin = above;
  lte_embedding* refused = nullptr;
  EXPECT_EQ(lte_model_encode(model.handle, &scene, &refused), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lte_last_error()).find("least corner"), std::string::npos);
}

TEST(CApi, HandlesServeManyThreadsAndOutliveTheirModel) {
  const nn::PointSet points = box_scene(300, 1);
  const nn::QuerySet queries = box_queries(300, 2);
  const at::Tensor alone = expected(points, queries);
  lte_embedding* embedding = nullptr;
  {
    const test::Model model;
    const lte_scene_points scene = c_points(points);
    ASSERT_EQ(lte_model_encode(model.handle, &scene, &embedding), LTE_OK) << lte_last_error();
  }
  ASSERT_EQ(lte_set_threads(2), LTE_OK);
  EXPECT_EQ(lte_threads(), 2);
  const lte_queries q = c_queries(queries);
  std::vector<at::Tensor> answers(4);
  std::vector<std::thread> threads;
  for (at::Tensor& answer : answers) {
    threads.emplace_back([&] {
      EXPECT_EQ(lte_threads(), 2);
      for (int i = 0; i < 3; ++i) answer = test::decode(embedding, q);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const at::Tensor& answer : answers) EXPECT_TRUE(at::equal(answer, alone));
  ASSERT_EQ(lte_set_threads(1), LTE_OK);
  EXPECT_EQ(lte_threads(), 1);
  lte_embedding_release(embedding);
}

/// The threads of a program that uses the library, which this test is but for its environment.
TEST(CApi, ThreadsSleepBetweenCalls) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor: nobody spins";
  const test::Model model;
  EXPECT_GE(test::worker_sleeps(100), 90);
}

}  // namespace
}  // namespace lte
