// Light maps in the programs that they are for: pictures of a baked room against path tracing.
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "lte/bake/formats/formats.h"
#include "lte/image/exr.h"
#include "lte/image/flip.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/pathtrace/render.h"
#include "tests/bake/quad_lightmap.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

using test::TempDir;

constexpr int kWidth = 128, kHeight = 96;
constexpr int kSkipped = 77;

class Engines : public testing::Test {
 protected:
  static const Lightmap& map() {
    static const Lightmap map = test::quad_lightmap(test::furnished_room(), 24, 96);
    return map;
  }

  /// What the camera sees, emission included.
  static const image::Image& reference() {
    static const image::Image picture = [] {
      const scene::Scene scene = test::furnished_room();
      const pathtrace::Bvh bvh(scene);
      const pathtrace::Lights lights(scene);
      pathtrace::RenderOptions options;
      options.spp = 96;
      return render_reference(bvh, lights, test::room_camera(), kWidth, kHeight, options);
    }();
    return picture;
  }
  /// Brings all but lamps below 1.
  static float exposure() { return image::auto_exposure(reference(), 0.95f, 0.8f); }

  void write(const Format& format, const FormatOptions& options) {
    FileSet files(folder_.path());
    format.write(map(), options, &files);
    files.commit();
    const scene::Camera camera = test::room_camera();
    const auto list = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
    view_ = {{"origin", list(camera.origin)},
             {"target", list(camera.target)},
             {"vfov", camera.vfov},
             {"width", kWidth},
             {"height", kHeight},
             {"exposure", exposure()}};
  }

  /// The exit code.
  int run(const std::string& command) {
    std::ofstream(folder_ / "view.json") << view_;
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// FLIP below 0.08, and mean luminance within 2 %, of pictures clamped to [0, 1].
  static void expect_alike(const image::Image& seen, const image::Image& expected) {
    ASSERT_EQ(seen.width, expected.width);
    ASSERT_EQ(seen.height, expected.height);
    const image::Image difference = image::flip(seen, expected);
    double error = 0, ours = 0, theirs = 0;
    for (size_t i = 0; i < difference.pixels.size(); ++i) {
      error += difference.pixels[i];
      ours += luminance(seen.rgb(i));
      theirs += luminance(expected.rgb(i));
    }
    error /= static_cast<double>(difference.pixels.size());
    RecordProperty("flip", std::to_string(error));
    EXPECT_LT(error, 0.08);
    EXPECT_NEAR(ours, theirs, 0.02 * theirs);
    std::printf("FLIP %.4f, luminance %.4f of %.4f\n", error, ours / theirs,
                theirs / static_cast<double>(difference.pixels.size()));
  }

  static image::Image clamped(image::Image linear, float exposure) {
    for (float& value : linear.pixels) value = std::clamp(value * exposure, 0.0f, 1.0f);
    return linear;
  }

  static image::Image from_png(const std::filesystem::path& path) {
    image::Image picture = image::read_png(path), out(picture.width, picture.height, 3);
    for (size_t i = 0; i < size_t{1} * picture.width * picture.height; ++i) {
      for (int c = 0; c < 3; ++c) {
        out.pixels[3 * i + static_cast<size_t>(c)] = image::srgb_to_linear(
            picture.pixels[static_cast<size_t>(picture.channels) * i + static_cast<size_t>(c)]);
      }
    }
    return out;
  }

  const TempDir folder_;
  nlohmann::json view_;
};

TEST_F(Engines, ThreeShowsWhatPathsDo) {
  // scripts/setup.sh --tests takes it out of PyPI's nicegui.
  const char* const chosen = std::getenv("LTE_THREE");
  const std::string three = chosen != nullptr ? chosen : LTE_SOURCE_DIR "/.venv/tests/three.js";
  if (!std::filesystem::exists(three)) GTEST_SKIP() << "no three.js (LTE_THREE)";
  FormatOptions options;
  options.three = three;
  write(engine_formats()[3], options);
  const std::string command = "python3 " LTE_SOURCE_DIR "/tests/bake/three_picture.py " +
                              folder_.path().string() + " " + (folder_ / "view.json").string() +
                              " " + (folder_ / "seen.png").string();
  view_["gains"] = {0, 1};
  const int code = run(command);
  if (code == kSkipped) GTEST_SKIP() << "no Chromium";
  ASSERT_EQ(code, 0);
  expect_alike(from_png(folder_ / "seen.png"), clamped(reference(), exposure()));

  // One lamp alone, by its slider.
  scene::Scene dimmed = test::furnished_room();
  const Rgb warm = dimmed.materials[3].emission;
  dimmed.materials[3].emission = warm * 1e-6f;
  const pathtrace::Bvh bvh(dimmed);
  const pathtrace::Lights lights(dimmed);
  pathtrace::RenderOptions render;
  render.spp = 96;
  image::Image expected =
      render_reference(bvh, lights, test::room_camera(), kWidth, kHeight, render);
  const image::Image lit = from_png(folder_ / "seen.gains.png");
  // The dimmed lamp itself still glows on the page.
  for (size_t i = 0; i < size_t{1} * kWidth * kHeight; ++i) {
    if (max_component(reference().rgb(i)) > 8) expected.set_rgb(i, reference().rgb(i));
  }
  expect_alike(lit, clamped(expected, exposure()));
}

TEST_F(Engines, BlenderShowsWhatPathsDo) {
  const char* const python = std::getenv("LTE_BPY_PYTHON");
  if (python == nullptr) GTEST_SKIP() << "no Python with bpy (LTE_BPY_PYTHON)";
  write(engine_formats()[1], {});
  const int code =
      run(std::string(python) + " " LTE_SOURCE_DIR "/tests/bake/blender_picture.py " +
          folder_.path().string() + " " + (folder_ / "view.json").string() + " " +
          (folder_ / "seen.exr").string() + " > " + (folder_ / "log").string() + " 2>&1");
  const std::string log = read_file(folder_ / "log");
  ASSERT_EQ(code, 0) << log;
  const size_t at = log.find("facts: ") + 7;
  const auto facts = nlohmann::json::parse(log.substr(at, log.find('\n', at) - at));
  EXPECT_EQ(facts["size"], (nlohmann::json{map().width, map().height}));
  EXPECT_EQ(facts["uv_layers"], (nlohmann::json{2}));
  EXPECT_EQ(facts["meshes"], map().placements.size());
  EXPECT_NEAR(facts["top_left"][0].get<double>(), map().total()[0] / kPi, 1e-3 * map().total()[0]);
  expect_alike(clamped(image::read_exr(folder_ / "seen.exr"), exposure()),
               clamped(reference(), exposure()));
}

}  // namespace
}  // namespace lte::bake
