// Every bad input gives a code and a line, and nothing passes the boundary but the functions of the
// header.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/c_api.h"
#include "tests/c_api/support.h"

namespace lte {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_status(lte_status got, lte_status status, const std::string& words) {
  const std::string message = lte_last_error();
  EXPECT_EQ(got, status) << message;
  EXPECT_NE(message.find(words), std::string::npos) << "no \"" << words << "\" in: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(CApiErrors, ModelsThatAreNone) {
  lte_model* model = nullptr;
  const auto open = [&](const char* path, const lte_model_options* options = nullptr) {
    model = reinterpret_cast<lte_model*>(&model);
    const lte_status status = lte_model_open(path, options, &model);
    EXPECT_EQ(model, nullptr);
    return status;
  };
  expect_status(open(nullptr), LTE_ERROR_INVALID_ARGUMENT, "path is null");
  expect_status(open("/nonexistent/model.safetensors"), LTE_ERROR_FILE,
                "/nonexistent/model.safetensors");
  expect_status(open("README.md"), LTE_ERROR_FILE, "README.md");
  expect_status(open("assets/data/homes-test/scenes/home_00000.safetensors"), LTE_ERROR_FILE,
                "not a model");
  expect_status(lte_model_open("README.md", nullptr, nullptr), LTE_ERROR_INVALID_ARGUMENT,
                "model is null");
  const std::string file = test::tiny_model_file().string();
  lte_model_options options = {};
  expect_status(open(file.c_str(), &options), LTE_ERROR_INVALID_ARGUMENT, "struct_size is 0");
  options.struct_size = sizeof options;
  options.device = -2;
  expect_status(open(file.c_str(), &options), LTE_ERROR_INVALID_ARGUMENT, "device is -2");
  options.device = 0;
  options.reserved = 1;
  expect_status(open(file.c_str(), &options), LTE_ERROR_INVALID_ARGUMENT, "reserved is 1");
  options.reserved = 0;
  options.device = 100;  // fewer than that many GPUs, with CUDA or without
  expect_status(open(file.c_str(), &options), LTE_ERROR_NO_CUDA, "device 100");
}

// Of version 1 of the interface, on 64 bits: programs have them compiled in.
static_assert(sizeof(lte_float3_view) == 16 && sizeof(lte_model_options) == 16 &&
              offsetof(lte_model_info, suns) == 64 &&
              offsetof(lte_scene_points, direct_back) == 136 &&
              offsetof(lte_scene_points, gloss) == 176 && sizeof(lte_embedding_info) == 88 &&
              sizeof(lte_queries) == 88);

TEST(CApiErrors, StructsMayGrowButNotUnknowingly) {
  const test::BoxScene points(60, 1);
  const test::Model model;
  struct Later {
    lte_scene_points known;
    int64_t added;
  } later = {points.in_c(), 0};
  later.known.struct_size = sizeof later;
  lte_embedding* embedding = nullptr;
  EXPECT_EQ(lte_model_encode(model.handle, &later.known, &embedding), LTE_OK) << lte_last_error();
  lte_embedding_release(embedding);
  lte_scene_points earlier = later.known;  // of a program that is older than the sides of light
  earlier.struct_size = offsetof(lte_scene_points, direct_back);
  earlier.direct_back.stride = -7;
  EXPECT_EQ(lte_model_encode(model.handle, &earlier, &embedding), LTE_OK) << lte_last_error();
  lte_embedding_release(embedding);
  later.added = 1;
  expect_status(lte_model_encode(model.handle, &later.known, &embedding),
                LTE_ERROR_INVALID_ARGUMENT, "does not know");
  EXPECT_EQ(embedding, nullptr);
  lte_model_info info = {};
  info.struct_size = 16;
  expect_status(lte_model_get_info(model.handle, &info), LTE_ERROR_INVALID_ARGUMENT,
                "struct_size is 16");
  EXPECT_EQ(info.parameters, 0);
  info.struct_size = offsetof(lte_model_info, suns);  // of a program that is older than the field
  info.suns = -7;
  EXPECT_EQ(lte_model_get_info(model.handle, &info), LTE_OK) << lte_last_error();
  EXPECT_GT(info.parameters, 0);
  EXPECT_EQ(info.suns, -7) << "beyond the end of the caller's struct";
  EXPECT_EQ(info.struct_size, 64u);
}

TEST(CApiErrors, BadScenePoints) {
  const test::Model model;
  struct Case {
    std::function<void(lte_scene_points&, test::BoxScene&)> spoil;
    const char* words;
  };
  static const float infinite[3] = {0, INFINITY, 0};
  const std::vector<Case> cases = {
      {[](auto& c, auto&) { c.count = 0; }, "count is 0"},
      {[](auto& c, auto&) { c.count = -5; }, "count is -5"},
      {[](auto& c, auto&) { c.count = int64_t{1} << 40; }, "more than 2^31"},
      {[](auto& c, auto&) { c.position.data = nullptr; }, "position is null"},
      {[](auto& c, auto&) { c.emission.data = nullptr; }, "emission is null"},
      {[](auto& c, auto&) { c.normal.stride = 8; }, "normal: stride is 8"},
      {[](auto& c, auto&) { c.normal.stride = 14; }, "normal: stride is 14"},
      {[](auto& c, auto&) { c.albedo.stride = -12; }, "albedo: stride is -12"},
      {[](auto& c, auto&) {
         c.albedo.data =
             reinterpret_cast<const float*>(reinterpret_cast<const char*>(c.albedo.data) + 2);
       },
       "albedo is not aligned"},
      {[](auto& c, auto&) { c.origin = infinite; }, "origin[1] is not finite"},
      {[](auto& c, auto&) { c.struct_size = 8; }, "struct_size is 8"},
      {[](auto&, auto& p) { p.position[7][1] = kNan; }, "position of row 7 is not finite"},
      {[](auto&, auto& p) { p.position[7][1] = INFINITY; }, "position of row 7 is not finite"},
      {[](auto&, auto& p) { p.normal[3][0] = kNan; }, "normal of row 3"},
      {[](auto&, auto& p) { p.normal[3][0] = 2; }, "normal of row 3"},
      {[](auto&, auto& p) { p.albedo[4][2] = -1; }, "albedo of row 4"},
      {[](auto&, auto& p) { p.emission[5][2] = -1; }, "emission of row 5"},
      {[](auto&, auto& p) { p.emission[5][2] = INFINITY; }, "emission of row 5"},
      {[](auto&, auto& p) { p.area[6] = -1; }, "area of row 6"},
  };
  for (const Case& c : cases) {
    test::BoxScene points(60, 1);
    lte_scene_points scene = points.in_c();
    c.spoil(scene, points);
    lte_embedding* embedding = reinterpret_cast<lte_embedding*>(&scene);
    expect_status(lte_model_encode(model.handle, &scene, &embedding), LTE_ERROR_INVALID_ARGUMENT,
                  c.words);
    EXPECT_EQ(embedding, nullptr);
  }
  lte_embedding* embedding = nullptr;
  const test::BoxScene points(60, 1);
  const lte_scene_points scene = points.in_c();
  expect_status(lte_model_encode(model.handle, nullptr, &embedding), LTE_ERROR_INVALID_ARGUMENT,
                "lte_scene_points is null");
  expect_status(lte_model_encode(nullptr, &scene, &embedding), LTE_ERROR_INVALID_ARGUMENT,
                "model is null");
  expect_status(lte_model_encode(model.handle, &scene, nullptr), LTE_ERROR_INVALID_ARGUMENT,
                "embedding is null");
}

TEST(CApiErrors, BadQueries) {
  const test::BoxScene points(60, 1);
  const test::Model model;
  const test::Embedding embedding(model.handle, points.in_c());
  struct Case {
    std::function<void(lte_queries&, test::BoxQueries&)> spoil;
    const char* words;
  };
  static const uint8_t byte = 1;
  const std::vector<Case> cases = {
      {[](auto& c, auto&) { c.count = -1; }, "count is -1"},
      {[](auto& c, auto&) { c.count = std::numeric_limits<int64_t>::max(); }, "addresses"},
      {[](auto& c, auto&) { c.position.data = nullptr; }, "position is null"},
      {[](auto& c, auto&) { c.albedo.stride = 11; }, "albedo: stride is 11"},
      {[](auto& c, auto&) { c.flags = 8; }, "unknown flags 8"},
      {[](auto& c, auto&) { c.reserved = 3; }, "reserved is 3"},
      {[](auto& c, auto&) { c.struct_size = 0; }, "struct_size is 0"},
      {[](auto& c, auto&) { c.mask = &byte, c.mask_stride = -1; }, "mask: stride is -1"},
      {[](auto&, auto& q) { q.position[9][0] = kNan; }, "position of row 9 is not finite"},
      {[](auto& c, auto& q) { q.position[9][0] = kNan, c.flags = LTE_QUERIES_TRUSTED; },
       "not finite"},
      {[](auto&, auto& q) { q.normal[8][2] = -3; }, "normal of row 8"},
      {[](auto&, auto& q) { q.albedo[7][1] = 17; }, "albedo of row 7"},
  };
  std::vector<float> out(3 * 20);
  for (const Case& c : cases) {
    test::BoxQueries set(20, 2);
    lte_queries queries = set.in_c();
    c.spoil(queries, set);
    expect_status(lte_embedding_decode(embedding.handle, &queries, out.data(), 0),
                  LTE_ERROR_INVALID_ARGUMENT, c.words);
  }
  const test::BoxQueries set(20, 2);
  lte_queries queries = set.in_c();
  const auto decode = [&](const lte_embedding* e, const lte_queries* q, float* to, int64_t stride) {
    return lte_embedding_decode(e, q, to, stride);
  };
  expect_status(decode(nullptr, &queries, out.data(), 0), LTE_ERROR_INVALID_ARGUMENT,
                "embedding is null");
  expect_status(decode(embedding.handle, nullptr, out.data(), 0), LTE_ERROR_INVALID_ARGUMENT,
                "lte_queries is null");
  expect_status(decode(embedding.handle, &queries, nullptr, 0), LTE_ERROR_INVALID_ARGUMENT,
                "irradiance is null");
  expect_status(decode(embedding.handle, &queries, out.data(), 6), LTE_ERROR_INVALID_ARGUMENT,
                "irradiance: stride is 6");
  queries = {};
  queries.struct_size = sizeof queries;
  EXPECT_EQ(decode(embedding.handle, &queries, nullptr, 0), LTE_OK);  // no queries, no arrays
}

TEST(CApiErrors, BadSettings) {
  const test::BoxScene points(60, 1);
  const test::Model model;
  const test::Embedding embedding(model.handle, points.in_c());
  const float negative[3] = {1, -1, 1}, nan[3] = {1, 1, kNan};
  const auto gain = [&](const float* rgb) {
    return lte_embedding_set_emission_gain(embedding.handle, rgb);
  };
  expect_status(gain(negative), LTE_ERROR_INVALID_ARGUMENT, "gain[1] is negative");
  expect_status(gain(nan), LTE_ERROR_INVALID_ARGUMENT, "gain[2] is not finite");
  expect_status(gain(nullptr), LTE_ERROR_INVALID_ARGUMENT, "gain is null");
  expect_status(lte_embedding_set_emission_gain(nullptr, nan), LTE_ERROR_INVALID_ARGUMENT,
                "embedding is null");
  for (const int32_t threads :
       {0, -1, std::numeric_limits<int32_t>::min(), 1 << 30, std::numeric_limits<int32_t>::max()}) {
    const int32_t before = lte_threads();
    expect_status(lte_set_threads(threads), LTE_ERROR_INVALID_ARGUMENT,
                  concat("threads is ", threads, ", expected 1 to ").c_str());
    EXPECT_EQ(lte_threads(), before);
  }
  expect_status(lte_embedding_get_info(embedding.handle, nullptr), LTE_ERROR_INVALID_ARGUMENT,
                "lte_embedding_info is null");
  lte_model_release(nullptr);
  lte_embedding_release(nullptr);
}

TEST(CApiErrors, DeviceMemoryNeedsCuda) {
  const test::BoxScene points(60, 1);
  const test::BoxQueries set(20, 2);
  const test::Model model;  // on the CPU
  const lte_scene_points scene = points.in_c();
  const test::Embedding embedding(model.handle, scene);
  const lte_queries queries = set.in_c();
  std::vector<float> out(3 * 20);
  lte_embedding* none = nullptr;
  const lte_status status = lte_built_with_cuda() ? LTE_ERROR_INVALID_ARGUMENT : LTE_ERROR_NO_CUDA;
  const char* words = lte_built_with_cuda() ? "opened on the CPU" : "built without CUDA";
  expect_status(lte_model_encode_cuda(model.handle, &scene, nullptr, &none), status, words);
  EXPECT_EQ(none, nullptr);
  expect_status(lte_embedding_decode_cuda(embedding.handle, &queries, nullptr, out.data(), 0),
                status, words);
  expect_status(lte_model_encode_cuda(nullptr, &scene, nullptr, &none), LTE_ERROR_INVALID_ARGUMENT,
                "model is null");
  expect_status(lte_embedding_decode_cuda(nullptr, &queries, nullptr, out.data(), 0),
                LTE_ERROR_INVALID_ARGUMENT, "embedding is null");
}

TEST(CApiErrors, TheLastErrorIsTheThreads) {
  EXPECT_EQ(lte_set_threads(-7), LTE_ERROR_INVALID_ARGUMENT);
  const std::string before = lte_last_error();
  std::thread([] {
    EXPECT_STREQ(lte_last_error(), "");
    EXPECT_EQ(lte_set_threads(-8), LTE_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(std::string(lte_last_error()).find("-8"), std::string::npos);
  }).join();
  EXPECT_EQ(lte_last_error(), before);
  lte_model* model = nullptr;
  const std::string path(5000, 'x');  // a message is cut, not overrun
  EXPECT_EQ(lte_model_open(path.c_str(), nullptr, &model), LTE_ERROR_FILE);
  EXPECT_LT(std::string(lte_last_error()).size(), size_t{1024});
}

/// The words of `text` that `pattern`'s first group matches.
std::set<std::string> words_of(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::set<std::string> out;
  for (std::sregex_iterator i(text.begin(), text.end(), expression), end; i != end; ++i) {
    out.insert((*i)[1]);
  }
  return out;
}

TEST(CApiErrors, TheLibraryExportsItsHeadersFunctionsAlone) {
  const std::string command = std::string("nm -D --defined-only ") + LTE_C_API_LIBRARY;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  ASSERT_NE(pipe, nullptr);
  std::string symbols;
  std::vector<char> line(4096);
  while (fgets(line.data(), static_cast<int>(line.size()), pipe.get()) != nullptr) {
    symbols += line.data();
  }
  std::stringstream headers;
  headers << std::ifstream("lte/c_api.h").rdbuf();
#ifdef LTE_RENDER_SCENE  // built with scenes
  headers << std::ifstream("lte/c_render.h").rdbuf();
#endif
  const auto declared = words_of(headers.str(), R"(LTE_API [a-z0-9_* ]*?(lte_[a-z0-9_]+)\()");
  EXPECT_GE(declared.size(), 20u);
  // All but absolute symbols, such as the version's own name.
  EXPECT_EQ(words_of(symbols, R"( [B-Zb-z] (\S+?)(?:@\S*)?\n)"), declared);
}

}  // namespace
}  // namespace lte
