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

#include <ATen/ATen.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/c_api.h"
#include "lte/nn/model_file.h"
#include "tests/c_api/support.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using testing::HasSubstr;

constexpr int64_t kPoints = 300, kQueries = 90, kEach = 4;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// It reads traced light and gloss, and casts rays.
nn::ModelConfig radiance_config() {
  nn::ModelConfig config = test::tiny_geometric_config();
  config.light_input = nn::LightInput::Traced;
  config.light_sides = nn::LightSides::Apart;
  config.gloss = true;
  config.radiance_lobes = 6;
  config.radiance_base = nn::RadianceBase::Points;
  return config;
}

nn::PointSet glossy_box() {
  nn::PointSet points = test::box_scene(kPoints, 1);
  points.gloss = at::zeros({kPoints, 2});
  points.gloss.select(1, 0).narrow(0, 0, kPoints / 2).fill_(1);
  points.gloss.select(1, 1).fill_(0.25);
  return points;
}

class CApiRadiance : public testing::Test {
 protected:
  CApiRadiance() : model_(radiance_config()) {
    test::randomize(*model_, 5);
    model_->eval();
    // Mostly along the normals, so that none lies below its surface.
    at::manual_seed(7);
    const at::Tensor way = queries_.normal.unsqueeze(1) + 0.5 * at::rand({kQueries, kEach, 3});
    directions_ = way.div(way.norm(2, {2}, true)).contiguous();
    open(model_, &handle_);
  }
  ~CApiRadiance() override { lte_model_release(handle_); }

  void open(nn::LightTransportModel& model, lte_model** handle) {
    nn::save_model(folder_ / "model.safetensors", model);
    ASSERT_EQ(lte_model_open((folder_ / "model.safetensors").c_str(), nullptr, handle), LTE_OK)
        << lte_last_error();
  }
  lte_scene_points scene() const {
    lte_scene_points scene = test::c_points(points_, /*light=*/true);
    scene.gloss = points_.gloss.const_data_ptr<float>();
    return scene;
  }
  at::Tensor expected(const nn::PointSet& points) {
    const at::NoGradGuard no_grad;
    return model_->decode_radiance(model_->encode(points), queries_, directions_);
  }
  lte_status ask(const lte_embedding* embedding, const lte_queries& queries, float* out) const {
    const lte_float3_view ways = test::view(directions_);
    return lte_embedding_decode_radiance(embedding, &queries, &ways, kEach, out, 0);
  }
  at::Tensor radiance(const lte_embedding* embedding, const lte_queries& queries) const {
    at::Tensor out = at::full({kQueries, kEach, 3}, -1.0f);
    EXPECT_EQ(ask(embedding, queries, out.data_ptr<float>()), LTE_OK) << lte_last_error();
    return out;
  }
  at::Tensor radiance(const lte_embedding* embedding) const {
    return radiance(embedding, test::c_queries(queries_));
  }

  test::TempDir folder_;
  nn::LightTransportModel model_;
  nn::PointSet points_ = glossy_box();
  nn::QuerySet queries_ = test::box_queries(kQueries, 2);
  at::Tensor directions_;
  lte_model* handle_ = nullptr;
};

TEST_F(CApiRadiance, ModelsSayWhatTheyReadAndAnswer) {
  const auto info_of = [](const lte_model* model) {
    lte_model_info info = {};
    info.struct_size = sizeof info;
    EXPECT_EQ(lte_model_get_info(model, &info), LTE_OK);
    return info;
  };
  const lte_model_info info = info_of(handle_);
  EXPECT_EQ(info.predicts_radiance, 1);
  EXPECT_EQ(info.gloss, 1);
  EXPECT_EQ(info.needs_area, 1) << "rays meet discs of the points' areas";
  const test::Model plain;
  const lte_model_info without = info_of(plain.handle);
  EXPECT_EQ(without.predicts_radiance, 0);
  EXPECT_EQ(without.gloss, 0);
  EXPECT_EQ(without.needs_area, 0);
  nn::ModelConfig config = test::tiny_config();
  config.light_input = nn::LightInput::Radiosity;
  nn::LightTransportModel solves(config);
  lte_model* handle = nullptr;
  open(solves, &handle);
  EXPECT_EQ(info_of(handle).needs_area, 1) << "light is solved between the points' areas";
  lte_model_release(handle);
}

TEST_F(CApiRadiance, AnswersAreTheCppNetworksInAnyLayout) {
  const test::Embedding embedding(handle_, scene());
  const at::Tensor right = expected(points_), got = radiance(embedding.handle);
  EXPECT_TRUE(at::equal(got, right));
  EXPECT_TRUE(got.isfinite().all().item<bool>());
  EXPECT_GT(got.mean().item<float>(), 0.01f);
  EXPECT_TRUE(at::equal(test::decode(embedding.handle, test::c_queries(queries_)),
                        [&] {
                          const at::NoGradGuard no_grad;
                          return model_->decode(model_->encode(points_), queries_);
                        }()))
      << "irradiance, from the same embedding";
  // Four floats a direction, five an answer.
  const at::Tensor ways =
      at::cat({at::full({kQueries, kEach, 1}, kNan), directions_}, 2).contiguous();
  const lte_float3_view view = {ways.const_data_ptr<float>() + 1, 16};
  const lte_queries queries = test::c_queries(queries_);
  at::Tensor out = at::full({kQueries, kEach, 5}, 7.0f);
  ASSERT_EQ(lte_embedding_decode_radiance(embedding.handle, &queries, &view, kEach,
                                          out.data_ptr<float>() + 1, 20),
            LTE_OK)
      << lte_last_error();
  EXPECT_TRUE(at::equal(out.narrow(2, 1, 3), right));
  EXPECT_TRUE(out.select(2, 0).eq(7).all().item<bool>());
  EXPECT_TRUE(out.select(2, 4).eq(7).all().item<bool>());
}

TEST_F(CApiRadiance, GlossIsReadAndItsLackIsMatt) {
  const test::Embedding metal(handle_, scene());
  lte_scene_points none = scene();
  none.gloss = nullptr;
  const test::Embedding matt(handle_, none);
  lte_scene_points earlier = scene();
  earlier.struct_size = offsetof(lte_scene_points, gloss);  // of a program older than the field
  earlier.gloss = reinterpret_cast<const float*>(1);
  const test::Embedding old(handle_, earlier);
  nn::PointSet zeros = points_;
  zeros.gloss = at::zeros({kPoints, 2});
  const at::Tensor flat = radiance(matt.handle);
  EXPECT_TRUE(at::equal(flat, expected(zeros)));
  EXPECT_TRUE(at::equal(radiance(old.handle), flat));
  EXPECT_GT(test::relative_difference(radiance(metal.handle), flat), 1e-3);
}

TEST_F(CApiRadiance, AGainScalesItByChannel) {
  const test::Embedding embedding(handle_, scene());
  const float gain[3] = {2, 0.5f, 0};
  ASSERT_EQ(lte_embedding_set_emission_gain(embedding.handle, gain), LTE_OK);
  EXPECT_LT(test::relative_difference(radiance(embedding.handle),
                                      expected(points_) * at::tensor({2.0f, 0.5f, 0.0f})),
            1e-6);
}

TEST_F(CApiRadiance, ASavedEmbeddingAnswersTheSameBits) {
  const test::Embedding made(handle_, scene());
  const std::string path = (folder_ / "scene.safetensors").string();
  ASSERT_EQ(lte_embedding_save(made.handle, path.c_str(), "box"), LTE_OK) << lte_last_error();
  lte_embedding* read = nullptr;
  ASSERT_EQ(lte_embedding_load(handle_, path.c_str(), "box", &read), LTE_OK) << lte_last_error();
  EXPECT_TRUE(at::equal(radiance(read), radiance(made.handle)));
  lte_embedding_info of_made = {}, of_read = {};
  of_made.struct_size = of_read.struct_size = sizeof of_made;
  ASSERT_EQ(lte_embedding_get_info(made.handle, &of_made), LTE_OK);
  ASSERT_EQ(lte_embedding_get_info(read, &of_read), LTE_OK);
  EXPECT_EQ(of_made.bytes, of_read.bytes);
  EXPECT_GE(of_made.bytes, kPoints * nn::Surfels::kColumns * 4) << "the discs count";
  lte_embedding_release(read);
}

TEST_F(CApiRadiance, MaskedQueriesAreNeitherReadNorAnsweredOtherThanZero) {
  const at::Tensor full = expected(points_);
  const at::Tensor mask = at::arange(kQueries).remainder(3).ne(0);
  const at::Tensor bytes = mask.to(at::kByte).contiguous();
  const at::Tensor out_of_use = mask.logical_not();
  for (at::Tensor* t : {&queries_.position, &queries_.normal, &queries_.albedo})
    t->masked_fill_(out_of_use.unsqueeze(1), kNan);
  directions_.masked_fill_(out_of_use.view({-1, 1, 1}), kNan);
  const test::Embedding embedding(handle_, scene());
  lte_queries queries = test::c_queries(queries_);
  queries.mask = bytes.const_data_ptr<uint8_t>();
  const at::Tensor right = at::where(mask.view({-1, 1, 1}), full, 0);
  for (const uint32_t flags : {0u, LTE_QUERIES_TRUSTED}) {
    queries.flags = flags;
    const at::Tensor got = radiance(embedding.handle, queries);
    EXPECT_LT(test::relative_difference(got, right), 1e-6);
    EXPECT_EQ(got.index({out_of_use}).abs().max().item<float>(), 0);
  }
  queries.flags = 0;
  directions_[4][2].fill_(1);  // seen by the mask: named by its own row
  std::vector<float> out(3 * kQueries * kEach);
  EXPECT_EQ(ask(embedding.handle, queries, out.data()), LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_THAT(lte_last_error(), HasSubstr("direction 2 of query 4 is not a unit vector"));
  const std::vector<uint8_t> none(kQueries, 0);
  queries.mask = none.data();
  EXPECT_EQ(radiance(embedding.handle, queries).abs().max().item<float>(), 0);
}

TEST_F(CApiRadiance, AHandleServesManyThreads) {
  const at::Tensor alone = expected(points_);
  const test::Embedding embedding(handle_, scene());
  std::vector<at::Tensor> answers(4);
  std::vector<std::thread> threads;
  for (at::Tensor& answer : answers) {
    threads.emplace_back([&] {
      for (int i = 0; i < 3; ++i) answer = radiance(embedding.handle);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const at::Tensor& answer : answers)
    EXPECT_LT(test::relative_difference(answer, alone), 1e-6);
}

void expect_refused(lte_status got, const std::string& words) {
  EXPECT_EQ(got, LTE_ERROR_INVALID_ARGUMENT) << words;
  EXPECT_THAT(lte_last_error(), HasSubstr(words));
  EXPECT_EQ(std::string(lte_last_error()).find('\n'), std::string::npos);
}

TEST_F(CApiRadiance, BadDirectionsAndArraysAreRefused) {
  const test::Embedding embedding(handle_, scene());
  const lte_queries queries = test::c_queries(queries_);
  std::vector<float> out(3 * kQueries * kEach);
  const at::Tensor good = directions_.clone();
  const auto spoiled = [&](const at::Tensor& way, const char* words) {
    directions_.copy_(good);
    directions_[3][1].copy_(way);
    expect_refused(ask(embedding.handle, queries, out.data()), words);
    lte_queries trusted = queries;
    trusted.flags = LTE_QUERIES_TRUSTED;
    EXPECT_EQ(ask(embedding.handle, trusted, out.data()), LTE_OK) << "the caller vouches";
  };
  spoiled(1.5 * good[3][1], "direction 1 of query 3 is not a unit vector");
  spoiled(at::full({3}, kNan), "direction 1 of query 3 is not a unit vector");
  spoiled(at::full({3}, INFINITY), "direction 1 of query 3 is not a unit vector");
  spoiled(at::zeros({3}), "direction 1 of query 3 is not a unit vector");
  spoiled(-queries_.normal[3], "direction 1 of query 3 points into the surface");
  directions_.copy_(good);

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
  const nn::PointSet points = test::box_scene(60, 1);
  const test::Embedding without(plain.handle, test::c_points(points));
  expect_refused(ask(without.handle, queries, out.data()), "predicts no radiance");
}

TEST_F(CApiRadiance, BadGlossAndMissingAreasAreRefused) {
  lte_embedding* embedding = nullptr;
  const auto refused = [&](const lte_scene_points& scene, const char* words) {
    expect_refused(lte_model_encode(handle_, &scene, &embedding), words);
    EXPECT_EQ(embedding, nullptr);
  };
  for (const float bad : {1.5f, -0.25f, kNan, INFINITY}) {
    points_ = glossy_box();
    points_.gloss[7][1] = bad;
    refused(scene(), "gloss (metallic, roughness) of row 7 is outside [0, 1]");
  }
  points_ = glossy_box();
  lte_scene_points crooked = scene();
  crooked.gloss = reinterpret_cast<const float*>(reinterpret_cast<const char*>(crooked.gloss) + 2);
  refused(crooked, "scene points: gloss is not aligned");
  lte_scene_points unknown = scene();
  unknown.area = nullptr;
  refused(unknown, "scene points: area is null");
}

TEST_F(CApiRadiance, DeviceMemoryNeedsCuda) {
  const test::Embedding embedding(handle_, scene());
  const lte_queries queries = test::c_queries(queries_);
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
