// Radiance by direction through the C functions: the C++ network's answers, gloss, and what is
// refused.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/c_api.h"
#include "tests/c_api/support.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::Rgbs;
using testing::HasSubstr;

constexpr int64_t kPoints = 300, kQueries = 90, kEach = 4;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// It reads traced light and gloss, and casts rays.
nn::ModelConfig radiance_config() {
  nn::ModelConfig config = test::tiny_geometric_config();
  config.light_input = nn::LightInput::Traced;
  config.radiance_lobes = 6;
  return config;
}

test::BoxScene glossy_box() {
  test::BoxScene scene(kPoints, 1);
  for (int64_t i = 0; i < kPoints; ++i)
    scene.gloss.insert(scene.gloss.end(), {i < kPoints / 2 ? 1.0f : 0.0f, 0.25f});
  return scene;
}

class CApiRadiance : public testing::Test {
 protected:
  CApiRadiance() : file_(save("radiance", radiance_config())), model_(file_), network_(file_) {
    Rng rng(7);
    for (const Vec3& normal : queries_.normal) {
      for (int64_t i = 0; i < kEach; ++i) {  // mostly along the normal, none below the surface
        const float x = rng.uniform(), y = rng.uniform();
        directions_.push_back(normalize(normal + 0.5f * Vec3{x, y, rng.uniform()}));
      }
    }
  }

  std::filesystem::path save(const std::string& name, const nn::ModelConfig& config) const {
    const std::filesystem::path file = folder_ / (name + ".safetensors");
    test::save_random_model(file, config);
    return file;
  }
  lte_scene_points scene() const { return scene_.in_c(/*light=*/true); }
  Rgbs expected(const test::BoxScene& scene) const {
    return runtime::SceneEmbedding(network_, scene.arrays(true))
        .decode_radiance(queries_.arrays(), directions_);
  }
  lte_status ask(const lte_embedding* embedding, const lte_queries& queries, float* out) const {
    const lte_float3_view ways = test::view(directions_);
    return lte_embedding_decode_radiance(embedding, &queries, &ways, kEach, out, 0);
  }
  Rgbs radiance(const lte_embedding* embedding, const lte_queries& queries) const {
    Rgbs out(directions_.size(), Rgb{-1, -1, -1});
    EXPECT_EQ(ask(embedding, queries, &out.data()->x), LTE_OK) << lte_last_error();
    return out;
  }
  Rgbs radiance(const lte_embedding* embedding) const {
    return radiance(embedding, queries_.in_c());
  }

  test::TempDir folder_;
  std::filesystem::path file_;
  test::Model model_;
  runtime::Network network_;
  test::BoxScene scene_ = glossy_box();
  test::BoxQueries queries_{kQueries, 2};
  std::vector<Vec3> directions_;
};

TEST_F(CApiRadiance, ModelsSayWhatTheyReadAndAnswer) {
  const lte_model_info info = model_.info();
  EXPECT_EQ(info.predicts_radiance, 1);
  EXPECT_EQ(info.gloss, 1);
  EXPECT_EQ(info.needs_area, 1) << "rays meet discs of the points' areas";
  const lte_model_info without = test::Model().info();
  EXPECT_EQ(without.predicts_radiance, 0);
  EXPECT_EQ(without.gloss, 0);
  EXPECT_EQ(without.needs_area, 0);
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Radiosity;
  EXPECT_EQ(test::Model(save("solves", config)).info().needs_area, 1)
      << "light is solved between the points' areas";
}

TEST_F(CApiRadiance, AnswersAreTheCppNetworksInAnyLayout) {
  const test::Embedding embedding(model_.handle, scene());
  const Rgbs right = expected(scene_);
  EXPECT_EQ(radiance(embedding.handle), right);
  double sum = 0;
  for (const Rgb& value : right) sum += double{value.x + value.y + value.z};
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_GT(sum / (3 * static_cast<double>(right.size())), 0.01);
  EXPECT_EQ(test::decode(embedding.handle, queries_.in_c()),
            runtime::SceneEmbedding(network_, scene_.arrays(true)).decode(queries_.arrays()))
      << "irradiance, from the same embedding";
  // Four floats a direction, five an answer.
  std::vector<float> ways;
  for (const Vec3& d : directions_) ways.insert(ways.end(), {kNan, d.x, d.y, d.z});
  const lte_float3_view view = {ways.data() + 1, 16};
  const lte_queries queries = queries_.in_c();
  std::vector<float> out(5 * directions_.size(), 7);
  ASSERT_EQ(
      lte_embedding_decode_radiance(embedding.handle, &queries, &view, kEach, out.data() + 1, 20),
      LTE_OK)
      << lte_last_error();
  for (size_t i = 0; i < right.size(); ++i) {
    const float* row = out.data() + 5 * i;
    EXPECT_EQ((Rgb{row[1], row[2], row[3]}), right[i]) << i;
    EXPECT_EQ(row[0], 7) << "what lies between the answers";
    EXPECT_EQ(row[4], 7);
  }
}

TEST_F(CApiRadiance, GlossIsReadAndItsLackIsMatt) {
  const test::Embedding metal(model_.handle, scene());
  lte_scene_points none = scene();
  none.gloss = nullptr;
  const test::Embedding matt(model_.handle, none);
  lte_scene_points earlier = scene();
  earlier.struct_size = offsetof(lte_scene_points, gloss);  // of a program older than the field
  earlier.gloss = reinterpret_cast<const float*>(1);
  const test::Embedding old(model_.handle, earlier);
  test::BoxScene zeros = scene_;
  zeros.gloss.assign(2 * kPoints, 0);
  const Rgbs flat = radiance(matt.handle);
  EXPECT_EQ(flat, expected(zeros));
  EXPECT_EQ(radiance(old.handle), flat);
  EXPECT_GT(test::relative_difference(radiance(metal.handle), flat), 1e-3);
}

TEST_F(CApiRadiance, AGainScalesItByChannel) {
  const test::Embedding embedding(model_.handle, scene());
  const float gain[3] = {2, 0.5f, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, gain), LTE_OK);
  EXPECT_LT(test::relative_difference(radiance(embedding.handle),
                                      test::scaled(expected(scene_), {2, 0.5f, 0})),
            1e-6);
}

TEST_F(CApiRadiance, ASavedEmbeddingAnswersTheSameBits) {
  const test::Embedding made(model_.handle, scene());
  const std::string path = (folder_ / "scene.safetensors").string();
  ASSERT_EQ(lte_embedding_save(made.handle, path.c_str(), "box"), LTE_OK) << lte_last_error();
  lte_embedding* read = nullptr;
  ASSERT_EQ(lte_embedding_load(model_.handle, path.c_str(), "box", &read), LTE_OK)
      << lte_last_error();
  EXPECT_EQ(radiance(read), radiance(made.handle));
  lte_embedding_info of_read = {};
  of_read.struct_size = sizeof of_read;
  ASSERT_EQ(lte_embedding_get_info(read, &of_read), LTE_OK);
  EXPECT_EQ(made.info().bytes, of_read.bytes);
  constexpr int64_t kDisc = 21 * 4;  // bytes, of each in surfels of embedding_file.h
  EXPECT_GE(made.info().bytes, kPoints * kDisc) << "the discs count";
  lte_embedding_release(read);
}

TEST_F(CApiRadiance, MaskedQueriesAreNeitherReadNorAnsweredOtherThanZero) {
  Rgbs right = expected(scene_);
  std::vector<uint8_t> mask(kQueries, 1);
  const Vec3 unread = {kNan, kNan, kNan};
  for (size_t i = 0; i < kQueries; i += 3) {
    mask[i] = 0;
    queries_.position[i] = queries_.normal[i] = queries_.albedo[i] = unread;
    for (size_t k = i * kEach; k < (i + 1) * kEach; ++k) {
      directions_[k] = unread;
      right[k] = {};
    }
  }
  const test::Embedding embedding(model_.handle, scene());
  lte_queries queries = queries_.in_c();
  queries.mask = mask.data();
  for (const uint32_t flags : {0u, LTE_QUERIES_TRUSTED}) {
    queries.flags = flags;
    const Rgbs got = radiance(embedding.handle, queries);
    EXPECT_LT(test::relative_difference(got, right), 1e-6);
    EXPECT_EQ(got[0], Rgb{});
    EXPECT_EQ(got[3 * kEach + 1], Rgb{});
  }
  queries.flags = 0;
  directions_[4 * kEach + 2] = {1, 1, 1};  // seen by the mask: named by its own row
  std::vector<float> out(3 * kQueries * kEach);
  EXPECT_EQ(ask(embedding.handle, queries, out.data()), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_THAT(lte_last_error(), HasSubstr("direction 2 of query 4 is not a unit vector"));
  const std::vector<uint8_t> none(kQueries, 0);
  queries.mask = none.data();
  EXPECT_EQ(radiance(embedding.handle, queries), Rgbs(directions_.size()));
}

TEST_F(CApiRadiance, AHandleServesManyThreads) {
  const Rgbs alone = expected(scene_);
  const test::Embedding embedding(model_.handle, scene());
  std::vector<Rgbs> answers(4);
  std::vector<std::thread> threads;
  for (Rgbs& answer : answers) {
    threads.emplace_back([&] {
      for (int i = 0; i < 3; ++i) answer = radiance(embedding.handle);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Rgbs& answer : answers) EXPECT_LT(test::relative_difference(answer, alone), 1e-6);
}

void expect_refused(lte_status got, const std::string& words) {
  EXPECT_EQ(got, LTE_ERROR_INVALID_ARGUMENT) << words;
  EXPECT_THAT(lte_last_error(), HasSubstr(words));
  EXPECT_EQ(std::string(lte_last_error()).find('\n'), std::string::npos);
}

TEST_F(CApiRadiance, BadDirectionsAndArraysAreRefused) {
  const test::Embedding embedding(model_.handle, scene());
  const lte_queries queries = queries_.in_c();
  std::vector<float> out(3 * kQueries * kEach);
  Vec3& spoilt = directions_[3 * kEach + 1];
  const Vec3 good = spoilt;
  const auto spoiled = [&](const Vec3& way, const char* words) {
    spoilt = way;
    expect_refused(ask(embedding.handle, queries, out.data()), words);
    lte_queries trusted = queries;
    trusted.flags = LTE_QUERIES_TRUSTED;
    EXPECT_EQ(ask(embedding.handle, trusted, out.data()), LTE_OK) << "the caller vouches";
  };
  spoiled(1.5f * good, "direction 1 of query 3 is not a unit vector");
  spoiled({kNan, kNan, kNan}, "direction 1 of query 3 is not a unit vector");
  spoiled({INFINITY, INFINITY, INFINITY}, "direction 1 of query 3 is not a unit vector");
  spoiled({}, "direction 1 of query 3 is not a unit vector");
  spoiled(-queries_.normal[3], "direction 1 of query 3 points into the surface");
  spoilt = good;

  const lte_float3_view ways = test::view(directions_), null = {nullptr, 0},
                        narrow = {ways.data, 8};
  const auto call = [&](const lte_float3_view* view, int64_t each, float* to, int64_t stride) {
    return lte_embedding_decode_radiance(embedding.handle, &queries, view, each, to, stride);
  };
  expect_refused(call(nullptr, kEach, out.data(), 0), "directions is null");
  expect_refused(call(&null, kEach, out.data(), 0), "directions is null");
  expect_refused(call(&narrow, kEach, out.data(), 0), "directions: stride is 8");
  expect_refused(call(&ways, 0, out.data(), 0), "directions_a_query is 0");
  expect_refused(call(&ways, std::numeric_limits<int64_t>::max(), out.data(), 0), "addresses");
  expect_refused(call(&ways, std::numeric_limits<int64_t>::max() / kQueries, out.data(), 0),
                 "addresses");
  expect_refused(call(&ways, kEach, nullptr, 0), "radiance is null");
  expect_refused(call(&ways, kEach, out.data(), 6), "radiance: stride is 6");
  expect_refused(lte_embedding_decode_radiance(nullptr, &queries, &ways, kEach, out.data(), 0),
                 "embedding is null");
  expect_refused(
      lte_embedding_decode_radiance(embedding.handle, nullptr, &ways, kEach, out.data(), 0),
      "lte_queries is null");
  lte_queries nobody = {};
  nobody.struct_size = sizeof nobody;
  EXPECT_EQ(lte_embedding_decode_radiance(embedding.handle, &nobody, &null, 1, nullptr, 0), LTE_OK);
  lte_queries unknown = queries;
  unknown.flags = 8;
  expect_refused(ask(embedding.handle, unknown, out.data()), "unknown flags 8");

  const test::Model plain;
  const test::BoxScene points(60, 1);
  const test::Embedding without(plain.handle, points.in_c());
  expect_refused(ask(without.handle, queries, out.data()), "predicts no radiance");
}

TEST_F(CApiRadiance, BadGlossAndMissingAreasAreRefused) {
  lte_embedding* embedding = nullptr;
  const auto refused = [&](const lte_scene_points& scene, const char* words) {
    expect_refused(lte_model_encode(model_.handle, &scene, &embedding), words);
    EXPECT_EQ(embedding, nullptr);
  };
  for (const float bad : {1.5f, -0.25f, kNan, INFINITY}) {
    scene_ = glossy_box();
    scene_.gloss[2 * 7 + 1] = bad;
    refused(scene(), "gloss (metallic, roughness) of row 7 is outside [0, 1]");
  }
  scene_ = glossy_box();
  lte_scene_points crooked = scene();
  crooked.gloss = reinterpret_cast<const float*>(reinterpret_cast<const char*>(crooked.gloss) + 2);
  refused(crooked, "scene points: gloss is not aligned");
  lte_scene_points unknown = scene();
  unknown.area = nullptr;
  refused(unknown, "scene points: area is null");
}

TEST_F(CApiRadiance, DeviceMemoryNeedsCuda) {
  const test::Embedding embedding(model_.handle, scene());
  const lte_queries queries = queries_.in_c();
  const lte_float3_view ways = test::view(directions_);
  std::vector<float> out(3 * kQueries * kEach);
  const lte_status got = lte_embedding_decode_radiance_cuda(embedding.handle, &queries, &ways,
                                                            kEach, nullptr, out.data(), 0);
  EXPECT_EQ(got, lte_built_with_cuda() ? LTE_ERROR_INVALID_ARGUMENT : LTE_ERROR_NO_CUDA);
  EXPECT_THAT(lte_last_error(),
              HasSubstr(lte_built_with_cuda() ? "opened on the CPU" : "built without CUDA"));
}

}  // namespace
}  // namespace lte
