// Every bad input of lte/c_render.h gives a code and a line.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/c_render.h"
#include "tests/c_api/support.h"

namespace lte {
namespace {

constexpr const char* kScene = "assets/scenes/cornell_box.glb";

// Of version 1 of the interface, on 64 bits: programs have them compiled in.
static_assert(sizeof(lte_scene_options) == 16 && sizeof(lte_scene_info) == 56 &&
              sizeof(lte_camera) == 56 && sizeof(lte_scene_encode_options) == 32 &&
              sizeof(lte_integrator_options) == 48 && sizeof(lte_picture) == 72 &&
              sizeof(lte_render_options) == 56);

class CRenderErrors : public testing::Test {
 protected:
  CRenderErrors() {
    EXPECT_EQ(lte_scene_open(kScene, nullptr, &scene_), LTE_OK) << lte_last_error();
    camera_.struct_size = sizeof camera_;
    EXPECT_EQ(lte_scene_get_camera(scene_, 0, &camera_), LTE_OK);
    lte_integrator_options path = {};
    path.struct_size = sizeof path;
    path.method = LTE_METHOD_PATH;
    EXPECT_EQ(lte_integrator_create(scene_, &path, &integrator_), LTE_OK);
    picture_.struct_size = sizeof picture_;
    picture_.width = picture_.height = 4;
    picture_.color = color_;
  }
  ~CRenderErrors() override {
    lte_integrator_release(integrator_);
    lte_scene_release(scene_);
  }

  static void expect(lte_status got, const std::string& words,
                     lte_status status = LTE_ERROR_INVALID_ARGUMENT) {
    const std::string message = lte_last_error();
    EXPECT_EQ(got, status) << message;
    EXPECT_NE(message.find(words), std::string::npos) << "no \"" << words << "\" in: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  lte_scene* scene_ = nullptr;
  lte_integrator* integrator_ = nullptr;
  lte_camera camera_ = {};
  lte_picture picture_ = {};
  float color_[3 * 16] = {};
};

TEST_F(CRenderErrors, Scenes) {
  auto* scene = reinterpret_cast<lte_scene*>(color_);
  expect(lte_scene_open("/nonexistent/room.glb", nullptr, &scene), "/nonexistent/room.glb",
         LTE_ERROR_FILE);
  EXPECT_EQ(scene, nullptr);
  expect(lte_scene_open("README.md", nullptr, &scene), "README.md", LTE_ERROR_FILE);
  expect(lte_scene_open(nullptr, nullptr, &scene), "path is null");
  expect(lte_scene_open(kScene, nullptr, nullptr), "scene is null");
  lte_scene_options options = {};
  expect(lte_scene_open(kScene, &options, &scene), "struct_size is 0");
  lte_scene_info info = {};
  expect(lte_scene_get_info(scene_, &info), "struct_size is 0");
  expect(lte_scene_get_info(nullptr, &info), "scene is null");
  lte_camera camera = {};
  camera.struct_size = sizeof camera;
  expect(lte_scene_get_camera(scene_, 99, &camera), "camera number is 99");
  expect(lte_scene_get_camera(scene_, -2, &camera), "camera number is -2");
  expect(lte_scene_get_camera(scene_, 0, nullptr), "lte_camera is null");
  lte_scene_release(nullptr);
  lte_integrator_release(nullptr);
}

TEST_F(CRenderErrors, Encoding) {
  const test::Model model;
  auto* embedding = reinterpret_cast<lte_embedding*>(color_);
  lte_scene_encode_options options = {};
  options.struct_size = sizeof options;
  options.scene_points = -1;
  expect(lte_scene_encode(scene_, model.handle, &options, &embedding), "scene_points is -1");
  EXPECT_EQ(embedding, nullptr);
  expect(lte_scene_encode(scene_, nullptr, nullptr, &embedding), "model is null");
  expect(lte_scene_encode(nullptr, model.handle, nullptr, &embedding), "scene is null");
  expect(lte_scene_encode(scene_, model.handle, nullptr, nullptr), "embedding is null");
}

TEST_F(CRenderErrors, Integrators) {
  struct Case {
    std::function<void(lte_integrator_options&)> spoil;
    const char* words;
  };
  const auto* embedding = reinterpret_cast<const lte_embedding*>(color_);  // never read
  const std::vector<Case> cases = {
      {[](auto& o) { o.method = 3; }, "method is 3"},
      {[](auto& o) { o.method = LTE_METHOD_NETWORK; }, "embedding is null"},
      {[&](auto& o) { o.embedding = embedding; }, "embedding is given"},
      {[](auto& o) { o.max_depth = -1; }, "max_depth is -1"},
      {[](auto& o) { o.records = int64_t{1} << 40; }, "records is 1099511627776"},
      {[](auto& o) { o.record_paths = -4; }, "record_paths is -4"},
      {[](auto& o) { o.reserved = 2; }, "reserved is 2"},
      {[](auto& o) { o.struct_size = 4; }, "struct_size is 4"},
  };
  for (const Case& c : cases) {
    lte_integrator_options options = {};
    options.struct_size = sizeof options;
    c.spoil(options);
    auto* integrator = reinterpret_cast<lte_integrator*>(color_);
    expect(lte_integrator_create(scene_, &options, &integrator), c.words);
    EXPECT_EQ(integrator, nullptr);
  }
  lte_integrator* integrator = nullptr;
  expect(lte_integrator_create(nullptr, nullptr, &integrator), "scene is null");
  expect(lte_integrator_create(scene_, nullptr, nullptr), "integrator is null");
}

TEST_F(CRenderErrors, Points) {
  struct Case {
    std::function<void(lte_queries&, test::BoxQueries&)> spoil;
    const char* words;
  };
  const std::vector<Case> cases = {
      {[](auto& c, auto&) { c.count = -1; }, "count is -1"},
      {[](auto& c, auto&) { c.position.data = nullptr; }, "position is null"},
      {[](auto& c, auto&) { c.normal.stride = 7; }, "normal: stride is 7"},
      {[](auto& c, auto&) { c.flags = 8; }, "unknown flags 8"},
      {[](auto&, auto& q) { q.position[9].y = NAN; }, "position of row 9 is not finite"},
      {[](auto&, auto& q) {
         q.normal[8] = {0, 2, 0};
       },
       "normal of row 8 is not unit"},
  };
  std::vector<float> light(3 * 20);
  for (const Case& c : cases) {
    test::BoxQueries set(20, 2);
    lte_queries points = set.in_c();
    points.albedo = {};  // not read
    c.spoil(points, set);
    expect(lte_integrator_irradiance(integrator_, &points, 1, 0, light.data(), nullptr, 0),
           c.words);
  }
  const test::BoxQueries set(20, 2);
  const lte_queries points = set.in_c();
  const auto at = [&](const lte_integrator* integrator, const lte_queries* from, int32_t samples,
                      int64_t stride) {
    return lte_integrator_irradiance(integrator, from, samples, 0, nullptr, light.data(), stride);
  };
  expect(at(integrator_, &points, 0, 0), "samples is 0");
  expect(at(integrator_, &points, 1 << 20, 0), "samples is 1048576");
  expect(at(integrator_, &points, 1, 6), "indirect: stride is 6");
  expect(at(integrator_, nullptr, 1, 0), "lte_queries is null");
  expect(at(nullptr, &points, 1, 0), "integrator is null");
}

TEST_F(CRenderErrors, Pictures) {
  struct Case {
    std::function<void(lte_camera&, lte_render_options&, lte_picture&)> spoil;
    const char* words;
  };
  const std::vector<Case> cases = {
      {[](auto&, auto&, auto& p) { p.width = 0; }, "width or height is 0"},
      {[](auto&, auto&, auto& p) { p.height = -3; }, "width or height is -3"},
      {[](auto&, auto&, auto& p) { p.width = 1 << 20; }, "width or height is 1048576"},
      {[](auto&, auto&, auto& p) { p.width = p.height = 1 << 15; }, "more than 2^28 pixels"},
      {[](auto&, auto& o, auto&) { o.passes = -1; }, "passes is -1"},
      {[](auto&, auto& o, auto&) { o.seconds = -1; }, "seconds is -1"},
      {[](auto&, auto& o, auto&) { o.seconds = NAN; }, "seconds is "},
      {[](auto&, auto& o, auto&) { o.reserved = 1; }, "reserved is 1"},
      {[](auto& c, auto&, auto&) { c.vfov = 180; }, "vfov is 180"},
      {[](auto& c, auto&, auto&) { c.origin[2] = INFINITY; }, "origin[2] is not finite"},
      {[](auto& c, auto&, auto&) { std::copy_n(c.origin, 3, c.target); }, "camera"},
      {[](auto& c, auto&, auto&) { c.struct_size = 0; }, "lte_camera: struct_size is 0"},
  };
  for (const Case& c : cases) {
    lte_camera camera = camera_;
    lte_picture picture = picture_;
    lte_render_options options = {};
    options.struct_size = sizeof options;
    c.spoil(camera, options, picture);
    expect(lte_render(integrator_, &camera, &options, &picture), c.words);
  }
  expect(lte_render(nullptr, &camera_, nullptr, &picture_), "integrator is null");
  expect(lte_render(integrator_, nullptr, nullptr, &picture_), "lte_camera is null");
  expect(lte_render(integrator_, &camera_, nullptr, nullptr), "lte_picture is null");
}

}  // namespace
}  // namespace lte
