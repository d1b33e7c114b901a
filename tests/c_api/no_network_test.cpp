// The C interface of a build without LibTorch: gathered and traced light as C++ has it, and one
// line for whoever wants a network.
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/c_render.h"
#include "tests/c_api/cpp_picture.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

constexpr const char* kBox = "assets/scenes/cornell_box.glb";
constexpr int kWidth = 24, kHeight = 18;

TEST(CNoNetwork, PicturesAreTheCppLibrarys) {
  lte_scene* scene = nullptr;
  ASSERT_EQ(lte_scene_open(kBox, nullptr, &scene), LTE_OK) << lte_last_error();
  lte_camera camera = {};
  camera.struct_size = sizeof camera;
  ASSERT_EQ(lte_scene_get_camera(scene, 0, &camera), LTE_OK);
  for (const lte_method method : {LTE_METHOD_GATHER, LTE_METHOD_PATH}) {
    lte_integrator_options options = {};
    options.struct_size = sizeof options;
    options.method = method;
    options.records = 512;
    lte_integrator* integrator = nullptr;
    ASSERT_EQ(lte_integrator_create(scene, &options, &integrator), LTE_OK) << lte_last_error();
    std::vector<Rgb> color(size_t{kWidth} * kHeight);
    lte_picture to = {};
    to.struct_size = sizeof to;
    to.width = kWidth;
    to.height = kHeight;
    to.color = &color[0].x;
    lte_render_options passes = {};
    passes.struct_size = sizeof passes;
    passes.passes = 1;
    EXPECT_EQ(lte_render(integrator, &camera, &passes, &to), LTE_OK) << lte_last_error();
    lte_integrator_release(integrator);

    const render::Frame frame = test::cpp_picture(kBox, method, kWidth, kHeight, 1);
    for (size_t i = 0; i < color.size(); ++i)
      ASSERT_EQ(color[i], frame.color.rgb(i)) << method << ", pixel " << i;
  }
  lte_scene_release(scene);
}

TEST(CNoNetwork, WantingOneIsRefusedInOneLine) {
  lte_model* model = nullptr;
  EXPECT_NE(lte_model_open("assets/models/lte-base.safetensors", nullptr, &model), LTE_OK);
  EXPECT_EQ(model, nullptr);
  EXPECT_THAT(lte_last_error(), testing::HasSubstr("no network, as it was made without LibTorch"));
  EXPECT_EQ(std::strchr(lte_last_error(), '\n'), nullptr);
  EXPECT_EQ(lte_built_with_cuda(), 0);
}

TEST(CNoNetwork, ThreadsAreThoseOfTheLibrary) {
  EXPECT_GE(lte_threads(), 1);
  ASSERT_EQ(lte_set_threads(2), LTE_OK);
  EXPECT_EQ(lte_threads(), 2);
}

TEST(CNoNetwork, TheExampleRendersTheCornellBox) {
  const test::TempDir folder;
  const std::string out = (folder / "box.ppm").string();
  const std::string command =
      std::string(LTE_RENDER_SCENE) + " " + kBox + " " + out + " 2>/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(std::filesystem::file_size(out), std::strlen("P6\n320 240\n255\n") + 3 * 320 * 240);
}

}  // namespace
}  // namespace lte
