// What the C functions compute: the C++ network's answers, in whatever layout, from any thread.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/c_api.h"
#include "tests/c_api/support.h"
#include "tests/support/temp_dir.h"
#include "tests/support/worker_sleeps.h"

namespace lte {
namespace {

using test::BoxQueries;
using test::BoxScene;
using test::Rgbs;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// What the C++ library answers from the same file.
Rgbs expected(const BoxScene& scene, const BoxQueries& queries,
              const runtime::EncodeOptions& options = {}) {
  const runtime::Network network(test::tiny_model_file());
  return runtime::SceneEmbedding(network, scene.arrays(), options).decode(queries.arrays());
}

/// The coordinates of triples with others beside them, row by row.
std::vector<float> interleaved(const std::vector<const std::vector<Vec3>*>& columns) {
  std::vector<float> out;
  for (size_t i = 0; i < columns.front()->size(); ++i)
    for (const auto* column : columns)
      for (int c = 0; c < 3; ++c) out.push_back((*column)[i][c]);
  return out;
}

TEST(CApi, TellsTheModelsProperties) {
  const test::Model model;
  const lte_model_info info = model.info();
  EXPECT_EQ(info.channels, 16);
  EXPECT_EQ(info.query_neighbours, 5);
  EXPECT_EQ(info.scene_points, 300);
  EXPECT_EQ(info.scene_points_pruned, 1);
  EXPECT_EQ(info.suns, 1);
  EXPECT_EQ(info.scale, 16);
  EXPECT_EQ(info.device, LTE_DEVICE_CPU);
  EXPECT_EQ(info.light_input, LTE_LIGHT_EMISSION);
  EXPECT_EQ(info.parameters, runtime::Network(test::tiny_model_file()).parameters());
  EXPECT_EQ(lte_abi_version(), uint32_t{LTE_C_API_VERSION});
  EXPECT_STREQ(lte_version_string(), "0.2.0");
}

TEST(CApi, AnswersAreTheCppNetworks) {
  const BoxScene scene(300, 1);
  const BoxQueries queries(500, 2);
  const test::Model model;
  const test::Embedding embedding(model.handle, scene.in_c());
  EXPECT_EQ(test::decode(embedding.handle, queries.in_c()), expected(scene, queries));
  const lte_embedding_info info = embedding.info();
  EXPECT_EQ(info.scene_points, 300);
  EXPECT_EQ(info.latents, 75);
  EXPECT_EQ(info.scale, 16);
  EXPECT_GE(info.bytes, 75 * 16 * 4);
  const auto cpp =
      runtime::SceneEmbedding(runtime::Network(test::tiny_model_file()), scene.arrays()).info();
  for (size_t i = 0; i < 3; ++i) {
    float least = INFINITY;
    for (const Vec3& p : scene.position) least = std::min(least, p[static_cast<int>(i)]);
    EXPECT_EQ(info.origin[i], least);
    EXPECT_EQ(info.radiance[i], cpp.emission[i]);
    EXPECT_GT(info.radiance[i], 0);
  }
}

TEST(CApi, AnEmbeddingIsSavedAndReadBack) {
  const test::TempDir folder;
  const std::string path = (folder / "scene.safetensors").string();
  const BoxQueries queries(500, 2);
  const BoxScene box(300, 1);
  const test::Model model;
  const test::Embedding made(model.handle, box.in_c());
  ASSERT_EQ(lte_embedding_save(made.handle, path.c_str(), "kitchen"), LTE_OK) << lte_last_error();
  lte_embedding* read = nullptr;
  ASSERT_EQ(lte_embedding_load(model.handle, path.c_str(), "kitchen", &read), LTE_OK)
      << lte_last_error();
  EXPECT_EQ(test::decode(read, queries.in_c()), test::decode(made.handle, queries.in_c()));
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
  const test::TempDir folder;
  test::save_random_model(folder / "traced.safetensors", config);
  const test::Model model(folder / "traced.safetensors");
  EXPECT_EQ(model.info().light_input, LTE_LIGHT_TRACED);
  const BoxScene scene(300, 1);
  const BoxQueries queries(50, 2);
  const test::Embedding embedding(model.handle, scene.in_c(/*light=*/true));
  const runtime::Network network(folder / "traced.safetensors");
  EXPECT_EQ(test::decode(embedding.handle, queries.in_c()),
            runtime::SceneEmbedding(network, scene.arrays(true)).decode(queries.arrays()));
  const lte_scene_points dark = scene.in_c();
  lte_embedding* none = nullptr;
  EXPECT_NE(lte_model_encode(model.handle, &dark, &none), LTE_OK);
  EXPECT_THAT(lte_last_error(), testing::HasSubstr("direct irradiance is missing"));
}

TEST(CApi, AModelThatReadsSidesAndErrorsIsGivenThem) {
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Traced;
  const test::TempDir folder;
  const std::filesystem::path file = folder / "apart.safetensors";
  test::save_random_model(file, config, {{"light_paths", "16"}, {"light_depth", "3"}});
  const test::Model model(file);
  const lte_model_info info = model.info();
  EXPECT_EQ(info.light_sides, 1);
  EXPECT_EQ(info.light_variance, 1);
  EXPECT_EQ(info.light_paths, 16);
  EXPECT_EQ(info.light_depth, 3);
  const BoxScene box(300, 1);
  const BoxQueries queries(50, 2);
  lte_scene_points scene = box.in_c(/*light=*/true);
  const test::Embedding embedding(model.handle, scene);
  EXPECT_EQ(
      test::decode(embedding.handle, queries.in_c()),
      runtime::SceneEmbedding(runtime::Network(file), box.arrays(true)).decode(queries.arrays()));
  lte_embedding* none = nullptr;
  const auto refused = [&](const lte_scene_points& points, const char* words) {
    EXPECT_NE(lte_model_encode(model.handle, &points, &none), LTE_OK);
    EXPECT_THAT(lte_last_error(), testing::HasSubstr(words));
  };
  scene.indirect_error = nullptr;
  refused(scene, "standard error of indirect irradiance is missing");
  scene.struct_size = offsetof(lte_scene_points, direct_back);  // of an older program
  refused(scene, "direct irradiance of the back is missing");
}

TEST(CApi, ReadsAndWritesInterleavedArrays) {
  const BoxScene box(300, 1);
  const BoxQueries queries(200, 2);
  const test::Model model;
  const std::vector<float> all =
      interleaved({&box.albedo, &box.emission, &box.position, &box.normal});
  lte_scene_points scene = box.in_c();
  scene.albedo = {all.data(), 48};
  scene.emission = {all.data() + 3, 48};
  scene.position = {all.data() + 6, 48};
  scene.normal = {all.data() + 9, 48};
  const test::Embedding embedding(model.handle, scene);

  const std::vector<Vec3> gap(200, Vec3{kNan, kNan, kNan});
  const std::vector<float> pixels =
      interleaved({&queries.position, &gap, &queries.normal, &queries.albedo});
  lte_queries q = queries.in_c();
  q.position = {pixels.data(), 48};
  q.normal = {pixels.data() + 6, 48};
  q.albedo = {pixels.data() + 9, 48};
  std::vector<float> out(5 * 200, 7);
  ASSERT_EQ(lte_embedding_decode(embedding.handle, &q, out.data() + 1, 20), LTE_OK)
      << lte_last_error();
  const Rgbs right = expected(box, queries);
  for (size_t i = 0; i < right.size(); ++i) {
    const float* row = out.data() + 5 * i;
    EXPECT_EQ((Rgb{row[1], row[2], row[3]}), right[i]) << i;
    EXPECT_EQ(row[0], 7) << "what lies between the answers";
    EXPECT_EQ(row[4], 7);
  }
}

TEST(CApi, WithoutAreasAllPointsCountTheSame) {
  BoxScene box(300, 1);
  const BoxQueries queries(50, 2);
  const test::Model model;
  lte_scene_points scene = box.in_c();
  scene.area = nullptr;
  const test::Embedding embedding(model.handle, scene);
  box.area.assign(300, 0.25f);
  EXPECT_LT(test::relative_difference(test::decode(embedding.handle, queries.in_c()),
                                      expected(box, queries)),
            1e-6);
}

TEST(CApi, MaskedQueriesAreNeitherReadNorAnsweredOtherThanZero) {
  const BoxScene scene(300, 1);
  BoxQueries queries(90, 2);
  Rgbs right = expected(scene, queries);
  std::vector<uint8_t> mask(2 * 90);
  for (size_t i = 0; i < 90; ++i) {
    mask[2 * i] = i % 3 == 0 ? 0 : 200;
    if (i % 3 != 0) continue;
    right[i] = {};
    for (auto* values : {&queries.position, &queries.normal, &queries.albedo})
      (*values)[i] = {kNan, kNan, kNan};
  }
  const test::Model model;
  const test::Embedding embedding(model.handle, scene.in_c());
  lte_queries q = queries.in_c();
  q.mask = mask.data();
  q.mask_stride = 2;
  for (const uint32_t flags : {0u, LTE_QUERIES_TRUSTED}) {
    q.flags = flags;
    EXPECT_EQ(test::decode(embedding.handle, q), right);
  }
  q.flags = 0;
  const std::vector<uint8_t> none(90, 0);
  q.mask = none.data();
  q.mask_stride = 1;
  EXPECT_EQ(test::decode(embedding.handle, q), Rgbs(90));
  q.mask = nullptr;
  float out[3 * 90];
  EXPECT_EQ(lte_embedding_decode(embedding.handle, &q, out, 0), LTE_ERROR_INVALID_ARGUMENT);
  queries.albedo[4].y = 20;  // seen by the mask: named by its own row
  q.mask = mask.data();
  q.mask_stride = 2;
  EXPECT_EQ(lte_embedding_decode(embedding.handle, &q, out, 0), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lte_last_error()).find("albedo of row 4"), std::string::npos);
}

TEST(CApi, EmissionGainIsTheEncodingOfScaledEmission) {
  const BoxScene scene(300, 1);
  const BoxQueries queries(60, 2);
  const test::Model model;
  const test::Embedding embedding(model.handle, scene.in_c());
  const lte_queries q = queries.in_c();
  const float doubled[3] = {2, 0.5f, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, doubled), LTE_OK);
  EXPECT_EQ(test::decode(embedding.handle, q),
            test::scaled(expected(scene, queries), {2, 0.5f, 0}));
  BoxScene brighter = scene;
  brighter.emission = test::scaled(scene.emission, {3, 0.7f, 1});
  const float tint[3] = {3, 0.7f, 1};  // over the first emission, not over the doubled
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, tint), LTE_OK);
  EXPECT_LT(
      test::relative_difference(test::decode(embedding.handle, q), expected(brighter, queries)),
      1e-6);
  const float none[3] = {0, 0, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, none), LTE_OK);
  EXPECT_EQ(test::decode(embedding.handle, q), Rgbs(60));
}

TEST(CApi, ASceneTooLargeIsRefusedOrShrunk) {
  BoxScene box(300, 1);
  BoxQueries queries(60, 2);
  const test::Model model;
  const auto scale = [&](float by) {
    for (auto* positions : {&box.position, &queries.position})
      *positions = test::scaled(*positions, {by, by, by});
  };
  scale(8);
  lte_scene_points scene = box.in_c();
  lte_embedding* refused = nullptr;
  EXPECT_EQ(lte_model_encode(model.handle, &scene, &refused), LTE_ERROR_SCENE_TOO_LARGE);
  EXPECT_EQ(refused, nullptr);
  EXPECT_STREQ(lte_last_error(),
               "scene points: the scene spans 40 m, the model knows scenes up to 16 m: set rescale "
               "to shrink it for the network");
  scene.rescale = 1;
  const test::Embedding embedding(model.handle, scene);
  const Rgbs got = test::decode(embedding.handle, queries.in_c());
  EXPECT_NEAR(embedding.info().scale, 40, 1e-3);
  EXPECT_EQ(got, expected(box, queries, {.rescale = true}));
  // As a scene that was made that small; ties between lattice points break otherwise.
  scale(0.4f);
  EXPECT_LT(test::relative_difference(got, expected(box, queries)), 0.02);
}

TEST(CApi, AGivenLeastCornerKeepsNetworkSpaceInPlace) {
  const BoxScene box(300, 1);
  const BoxQueries queries(60, 2);
  const test::Model model;
  lte_scene_points scene = box.in_c();
  const float corner[3] = {-0.5f, -0.25f, -1};
  scene.origin = corner;
  const test::Embedding embedding(model.handle, scene);
  const lte_embedding_info info = embedding.info();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(info.origin[i], corner[i]);
  const Rgbs got = test::decode(embedding.handle, queries.in_c());
  EXPECT_EQ(got, expected(box, queries, {.origin = Vec3{-0.5f, -0.25f, -1}}));
  EXPECT_NE(got, expected(box, queries));
  const float above[3] = {0.5f, 0, 0};
  scene.origin = above;
  lte_embedding* refused = nullptr;
  EXPECT_EQ(lte_model_encode(model.handle, &scene, &refused), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lte_last_error()).find("least corner"), std::string::npos);
}

TEST(CApi, HandlesServeManyThreadsAndOutliveTheirModel) {
  const BoxScene box(300, 1);
  const BoxQueries queries(300, 2);
  const Rgbs alone = expected(box, queries);
  lte_embedding* embedding = nullptr;
  {
    const test::Model model;
    const lte_scene_points scene = box.in_c();
    ASSERT_EQ(lte_model_encode(model.handle, &scene, &embedding), LTE_OK) << lte_last_error();
  }
  ASSERT_EQ(lte_set_threads(2), LTE_OK);
  EXPECT_EQ(lte_threads(), 2);
  std::vector<Rgbs> answers(4);
  std::vector<std::thread> threads;
  for (Rgbs& answer : answers) {
    threads.emplace_back([&] {
      EXPECT_EQ(lte_threads(), 2);
      for (int i = 0; i < 3; ++i) answer = test::decode(embedding, queries.in_c());
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Rgbs& answer : answers) EXPECT_EQ(answer, alone);
  ASSERT_EQ(lte_set_threads(1), LTE_OK);
  EXPECT_EQ(lte_threads(), 1);
  lte_embedding_release(embedding);
}

/// The threads of a program that uses the library, which this test is but for its environment.
TEST(CApi, ThreadsSleepBetweenCalls) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor: nobody spins";
  const BoxScene scene(300, 1);
  const BoxQueries queries(2000, 2);
  const test::Model model;
  const test::Embedding embedding(model.handle, scene.in_c());
  ASSERT_EQ(lte_set_threads(2), LTE_OK);
  const auto decode = [&] { test::decode(embedding.handle, queries.in_c()); };
  EXPECT_GE(test::worker_sleeps(50, decode), 45);
  ASSERT_EQ(lte_set_threads(1), LTE_OK);
}

}  // namespace
}  // namespace lte
