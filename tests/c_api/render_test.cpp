// What the functions of lte/c_render.h compute: the C++ library's pictures, and light that closed
// forms and paths find too.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "lte/c_render.h"
#include "lte/embed/embed.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/scene/export.h"
#include "lte/scene/load.h"
#include "tests/c_api/cpp_picture.h"
#include "tests/c_api/support.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

namespace fs = std::filesystem;
using test::Rgbs;

constexpr const char* kBox = "assets/scenes/cornell_box.glb";
constexpr int kWidth = 32, kHeight = 24;
constexpr size_t kPixels = size_t{kWidth} * kHeight;

/// A handle that is released at the end.
template <typename T, void (*release)(T*)>
struct Handle {
  T* it = nullptr;
  Handle() = default;
  ~Handle() { release(it); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
};
using Integrator = Handle<lte_integrator, lte_integrator_release>;
struct Scene : Handle<lte_scene, lte_scene_release> {
  explicit Scene(const fs::path& path = kBox) {
    EXPECT_EQ(lte_scene_open(path.c_str(), nullptr, &it), LTE_OK) << lte_last_error();
  }
};

lte_camera camera_of(const Scene& scene, int64_t number = 0) {
  lte_camera camera = {};
  camera.struct_size = sizeof camera;
  EXPECT_EQ(lte_scene_get_camera(scene.it, number, &camera), LTE_OK) << lte_last_error();
  return camera;
}

lte_integrator_options by(lte_method method) {
  lte_integrator_options options = {};
  options.struct_size = sizeof options;
  options.method = method;
  options.records = 512;
  return options;
}

lte_render_options passes(int count) {
  lte_render_options options = {};
  options.struct_size = sizeof options;
  options.passes = count;
  return options;
}

/// All layers of a picture.
struct Picture {
  Rgbs color{kPixels}, albedo{kPixels}, normal{kPixels}, emission{kPixels}, direct{kPixels},
      indirect{kPixels};
  std::vector<float> depth = std::vector<float>(kPixels);

  Picture(const lte_integrator* integrator, const lte_camera& camera,
          const lte_render_options& options) {
    lte_picture to = {};
    to.struct_size = sizeof to;
    to.width = kWidth;
    to.height = kHeight;
    to.color = &color[0].x;
    to.albedo = &albedo[0].x;
    to.normal = &normal[0].x;
    to.depth = depth.data();
    to.emission = &emission[0].x;
    to.direct = &direct[0].x;
    to.indirect = &indirect[0].x;
    EXPECT_EQ(lte_render(integrator, &camera, &options, &to), LTE_OK) << lte_last_error();
  }
};

TEST(CRender, PicturesAreTheCppLibrarysAndTheSumOfTheirLayers) {
  const Scene file;
  for (const lte_method method : {LTE_METHOD_GATHER, LTE_METHOD_PATH}) {
    Integrator integrator;
    const lte_integrator_options options = by(method);
    ASSERT_EQ(lte_integrator_create(file.it, &options, &integrator.it), LTE_OK) << lte_last_error();
    const Picture got(integrator.it, camera_of(file), passes(2));

    const render::Frame frame = test::cpp_picture(kBox, method, kWidth, kHeight, 2);
    for (size_t i = 0; i < kPixels; ++i) {
      ASSERT_EQ(got.color[i], frame.color.rgb(i)) << method << ", pixel " << i;
      ASSERT_EQ(got.indirect[i], frame.indirect.rgb(i));
      ASSERT_EQ(got.normal[i], frame.normal.rgb(i));
      ASSERT_EQ(got.depth[i], frame.depth.pixels[i]);
      const Rgb light = got.direct[i] + got.indirect[i];
      for (int c = 0; c < 3; ++c) {
        const float sum =
            got.emission[i][c] + got.albedo[i][c] * light[c] / std::numbers::pi_v<float>;
        ASSERT_NEAR(got.color[i][c], sum, 1e-5f * (1 + sum));
      }
    }
  }
}

TEST(CRender, LayersThatAreNotWantedAreNotWrittenAndThreadsChangeNothing) {
  const Scene scene;
  Integrator integrator;
  ASSERT_EQ(lte_integrator_create(scene.it, nullptr, &integrator.it), LTE_OK);
  const lte_camera camera = camera_of(scene);
  ASSERT_EQ(lte_set_threads(1), LTE_OK);
  const Picture all(integrator.it, camera, passes(1));
  ASSERT_EQ(lte_set_threads(2), LTE_OK);
  Rgbs albedo(kPixels);
  lte_picture some = {};
  some.struct_size = sizeof some;
  some.width = kWidth;
  some.height = kHeight;
  some.albedo = &albedo[0].x;
  const lte_render_options once = passes(1);
  ASSERT_EQ(lte_render(integrator.it, &camera, &once, &some), LTE_OK) << lte_last_error();
  // Edges get more camera rays where no light is wanted.
  size_t other_pixels = 0;
  for (size_t i = 0; i < kPixels; ++i) other_pixels += albedo[i] != all.albedo[i];
  EXPECT_LT(other_pixels, kPixels / 4);
  const Picture again(integrator.it, camera, passes(1));
  EXPECT_EQ(again.color, all.color);
  lte_render_options other = passes(1);
  other.seed = 7;
  EXPECT_NE(Picture(integrator.it, camera, other).color, all.color);
}

TEST(CRender, ProgressGrowsAndMayEndAPicture) {
  const Scene scene;
  Integrator integrator;
  const lte_integrator_options path = by(LTE_METHOD_PATH);
  ASSERT_EQ(lte_integrator_create(scene.it, &path, &integrator.it), LTE_OK);
  struct Calls {
    std::vector<double> shares;
    double until;
  } calls = {{}, 2};
  lte_render_options options = passes(4);
  options.progress = [](void* user, double share) -> int32_t {
    auto* to = static_cast<Calls*>(user);
    to->shares.push_back(share);
    return share >= to->until;
  };
  options.user = &calls;
  const Picture whole(integrator.it, camera_of(scene), options);
  EXPECT_EQ(calls.shares.front(), 0);
  EXPECT_EQ(calls.shares.back(), 1);
  EXPECT_TRUE(std::is_sorted(calls.shares.begin(), calls.shares.end()));
  calls = {{}, 0.5};
  const lte_camera camera = camera_of(scene);
  Rgbs color(kPixels);
  lte_picture to = {};
  to.struct_size = sizeof to;
  to.width = kWidth;
  to.height = kHeight;
  to.color = &color[0].x;
  EXPECT_EQ(lte_render(integrator.it, &camera, &options, &to), LTE_STOPPED);
  EXPECT_EQ(calls.shares.back(), 0.5);
}

/// Two parallel plates, the upper one a lamp, and points on the lower one.
TEST(CRender, DirectLightIsThatOfTheClosedForm) {
  scene::Scene plates;
  const int gray = test::add_material(&plates, {0.5f, 0.5f, 0.5f});
  const int lamp = test::add_material(&plates, {}, {3, 2, 1});
  test::add_quad(&plates, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, gray);
  test::add_quad(&plates, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, lamp);
  const test::TempDir folder;
  scene::write_glb(folder / "plates.glb", plates);
  const Scene scene(folder / "plates.glb");
  Integrator integrator;
  const lte_integrator_options options = by(LTE_METHOD_PATH);
  ASSERT_EQ(lte_integrator_create(scene.it, &options, &integrator.it), LTE_OK);
  const std::vector<Vec3> position(2, Vec3{0, 0, 0}), normal(2, Vec3{0, 1, 0});
  const std::vector<uint8_t> mask = {1, 0};
  lte_queries points = {};
  points.struct_size = sizeof points;
  points.count = 2;
  points.position = test::view(position);
  points.normal = test::view(normal);
  points.mask = mask.data();
  std::vector<float> direct(8, -1), indirect(8, -1);
  ASSERT_EQ(lte_integrator_irradiance(integrator.it, &points, 4096, 1, direct.data(),
                                      indirect.data(), 16),
            LTE_OK)
      << lte_last_error();
  // The form factor of a square of side 2 at distance 1 over its middle is four times that of a
  // corner, which is a atan(a) / pi with a = 1/sqrt(2).
  const double a = 1 / std::sqrt(2.0), factor = 4 / std::numbers::pi * a * std::atan(a);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(direct[static_cast<size_t>(c)], (3 - c) * std::numbers::pi * factor, 0.05);
    EXPECT_EQ(indirect[static_cast<size_t>(c)], 0) << "the lamp is black, so nothing comes back";
    EXPECT_EQ(direct[static_cast<size_t>(4 + c)], 0) << "masked";
  }
  EXPECT_EQ(direct[3], -1) << "between the rows";
}

TEST(CRender, IntegratorsAgreeWithPathsOfTheLayerBelow) {
  const Scene file;
  const scene::Scene loaded = scene::load_scene(kBox);
  const pathtrace::Bvh bvh(loaded);
  const pathtrace::Lights lights(loaded);
  const scene::SurfaceSamples surface = scene::sample_surface(loaded, 200, {.seed = 3});
  const pathtrace::Irradiance truth =
      pathtrace::estimate_irradiance(bvh, lights, surface.position, surface.normal, {.rays = 512});
  const auto total = [](const Rgbs& light) {
    double sum = 0;
    for (const Rgb& value : light) sum += double{value.x} + value.y + value.z;
    return sum;
  };
  lte_queries points = {};
  points.struct_size = sizeof points;
  points.count = 200;
  points.position = test::view(surface.position);
  points.normal = test::view(surface.normal);
  for (const lte_method method : {LTE_METHOD_GATHER, LTE_METHOD_PATH}) {
    Integrator integrator;
    const lte_integrator_options options = by(method);
    ASSERT_EQ(lte_integrator_create(file.it, &options, &integrator.it), LTE_OK);
    Rgbs direct(200), indirect(200), alone(200);
    ASSERT_EQ(
        lte_integrator_irradiance(integrator.it, &points, 64, 1, &direct[0].x, &indirect[0].x, 0),
        LTE_OK)
        << lte_last_error();
    EXPECT_NEAR(total(direct), total(truth.direct), 0.03 * total(truth.direct)) << method;
    EXPECT_NEAR(total(indirect), total(truth.indirect), 0.03 * total(truth.indirect)) << method;
    ASSERT_EQ(lte_integrator_irradiance(integrator.it, &points, 64, 1, nullptr, &alone[0].x, 0),
              LTE_OK);
    EXPECT_EQ(alone, indirect);
  }
}

TEST(CRender, ANetworksLightIsThatOfItsEmbedding) {
  const Scene file;
  const test::Model model;
  lte_scene_encode_options how = {};
  how.struct_size = sizeof how;
  how.scene_points = 400;
  how.seed = 5;
  Handle<lte_embedding, lte_embedding_release> embedding;
  ASSERT_EQ(lte_scene_encode(file.it, model.handle, &how, &embedding.it), LTE_OK)
      << lte_last_error();
  const test::BoxQueries queries(50, 2);
  const scene::Scene loaded = scene::load_scene(kBox);
  const pathtrace::Bvh bvh(loaded);
  const pathtrace::Lights lights(loaded);
  embed::EmbedSettings settings;
  settings.scene_points = 400;
  settings.seed = 5;
  const runtime::Network network(test::tiny_model_file());
  EXPECT_EQ(test::decode(embedding.it, queries.in_c()),
            embed::embed(bvh, lights, network, settings).embedding.decode(queries.arrays()));

  Integrator integrator;
  lte_integrator_options options = by(LTE_METHOD_NETWORK);
  options.embedding = embedding.it;
  ASSERT_EQ(lte_integrator_create(file.it, &options, &integrator.it), LTE_OK) << lte_last_error();
  lte_embedding_release(embedding.it);  // needed no more
  embedding.it = nullptr;
  const lte_camera camera = camera_of(file);
  const Picture by_network(integrator.it, camera, passes(1));
  Integrator gather;
  const lte_integrator_options traced = by(LTE_METHOD_GATHER);
  ASSERT_EQ(lte_integrator_create(file.it, &traced, &gather.it), LTE_OK);
  EXPECT_NE(by_network.indirect, Picture(gather.it, camera, passes(1)).indirect);
}

TEST(CRender, ScenesHaveSizesAndCameras) {
  const Scene file;
  lte_scene_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(lte_scene_get_info(file.it, &info), LTE_OK);
  const scene::Scene loaded = scene::load_scene(kBox);
  EXPECT_EQ(info.triangles, loaded.triangle_count());
  EXPECT_EQ(info.cameras, static_cast<int64_t>(loaded.cameras.size()));
  EXPECT_EQ(info.lights, static_cast<int64_t>(loaded.light_groups.size()));
  const Bounds bounds = loaded.bounds();
  EXPECT_EQ(info.bounds_min[1], bounds.low.y);
  EXPECT_EQ(info.bounds_max[2], bounds.high.z);
  EXPECT_EQ(camera_of(file).vfov, loaded.cameras[0].vfov);
  EXPECT_GT(camera_of(file, LTE_CAMERA_AUTO).vfov, 0);
  lte_scene_options turned = {};
  turned.struct_size = sizeof turned;
  turned.z_up = 1;
  Handle<lte_scene, lte_scene_release> on_its_side;
  ASSERT_EQ(lte_scene_open(kBox, &turned, &on_its_side.it), LTE_OK);
  ASSERT_EQ(lte_scene_get_info(on_its_side.it, &info), LTE_OK);
  EXPECT_EQ(info.bounds_max[1], bounds.high.z);
}

TEST(CRender, TheExampleRendersTheCornellBox) {
  const test::TempDir folder;
  const std::string out = (folder / "box.ppm").string();
  const std::string command = std::string(LTE_RENDER_SCENE) + " " + kBox + " " + out + " ";
  ASSERT_EQ(std::system((command + test::tiny_model_file().string() + " 2>/dev/null").c_str()), 0);
  ASSERT_EQ(std::system((command + " 2>/dev/null").c_str()), 0);
  EXPECT_EQ(fs::file_size(out), std::strlen("P6\n320 240\n255\n") + 3 * 320 * 240);
  EXPECT_NE(
      std::system((std::string(LTE_RENDER_SCENE) + " README.md " + out + " 2>/dev/null").c_str()),
      0);
}

}  // namespace
}  // namespace lte
