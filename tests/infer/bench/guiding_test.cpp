// lte_bench guiding: ways to draw paths, of one mean.
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/bench/bench.h"
#include "infer/bench/guiding/guided_irradiance.h"
#include "infer/bench/guiding/guided_pixels.h"
#include "lte/base/check.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

/// A furnished room, some of it metal, and an untrained model's embedding of it.
class Guiding : public testing::Test {
 protected:
  Guiding() : scene_(test::furnished_room()) {
    scene_.materials[1].metallic = 1;
    scene_.materials[1].roughness = 0.3f;
    const test::TempDir folder;
    test::save_tiny_model(folder / "m.safetensors", {.radiance_lobes = 4, .gloss = true});
    EmbedSettings settings;
    settings.rescale = true;
    renderer_.emplace(scene_);
    renderer_->embed(runtime::Network(folder / "m.safetensors"), settings);
    options_.width = 32;
    options_.height = 24;
    options_.radius_m = 0.5;
  }
  static double figure(const GuidingRow& row, const std::string& name) {
    return row.figures.at(name);
  }
  static void expect_near(const GuidingRow& row, const std::string& name, double expected,
                          double share) {
    EXPECT_NEAR(figure(row, name), expected, share * expected) << row.name << ", " << name;
  }

  scene::Scene scene_;
  std::optional<Renderer> renderer_;
  GuidingOptions options_;
};

TEST_F(Guiding, OfPixelsHasOneMeanWhateverTheWay) {
  options_.columns = 12;
  options_.rows = 9;
  options_.paths = 512;
  const std::vector<GuidingRow> rows =
      guided_pixels(*renderer_, pathtrace::auto_camera(renderer_->bvh()), options_);
  ASSERT_EQ(rows.size(), 13u);
  const GuidingRow &plain = rows[0], &lights = rows[1];
  const double mean = figure(plain, "mean"), whole = figure(plain, "whole_mean");
  EXPECT_GT(mean, 0);
  EXPECT_GT(whole, 1.05 * mean);
  const double variance = figure(plain, "relative_variance_8");
  expect_near(plain, "relative_variance_2", 4 * variance, 1e-6);
  EXPECT_EQ(figure(lights, "relative_variance_8"), variance) << "the same paths";
  // Lamps bring the same whether paths meet them or samples find them.
  expect_near(lights, "whole_mean", whole, 0.06);
  for (size_t i = 2; i < rows.size(); ++i) {
    const GuidingRow& row = rows[i];
    expect_near(row, "mean", mean, 0.04);
    expect_near(row, "whole_mean", whole, 0.06);
    // An untrained guide is no better, and no worse than its share.
    EXPECT_LT(figure(row, "relative_variance_8"), 4 * variance) << row.name;
    const double seconds = figure(row, "prediction_seconds") + figure(row, "table_seconds") +
                           8 * figure(row, "path_seconds");
    expect_near(row, "cost_8", figure(row, "relative_variance_8") * seconds, 1e-6);
    expect_near(row, "whole_cost_8",
                figure(row, "whole_variance_8") * (seconds + 8 * figure(row, "light_seconds")),
                1e-6);
  }
  const GuidingRow &own = rows[3], &shared = rows[6], &traced = rows[8];
  EXPECT_GT(figure(own, "maps"), 80) << "one a pixel";
  EXPECT_LT(figure(shared, "maps"), 500) << "fewer than the picture has pixels";
  EXPECT_EQ(figure(shared, "maps"), figure(traced, "maps"));
  // Maps that were traced tell more than an untrained network's.
  EXPECT_LT(figure(traced, "relative_variance_8"), figure(shared, "relative_variance_8"));
}

TEST_F(Guiding, OfIrradianceHasOneMeanWhateverTheWay) {
  options_.query_points = 1024;
  const std::vector<GuidingRow> rows = guided_irradiance(*renderer_, options_);
  ASSERT_EQ(rows.size(), 6u);
  const double mean = figure(rows[0], "mean");
  EXPECT_GT(mean, 0);
  for (const GuidingRow& row : rows) {
    expect_near(row, "mean", mean, 0.04);
    expect_near(row, "relative_variance_1024", figure(row, "relative_variance_256") / 4, 1e-6);
    EXPECT_LT(figure(row, "relative_variance_256"), figure(row, "relative_variance_64"));
  }
  EXPECT_EQ(figure(rows[1], "maps"), 64);
  EXPECT_LT(figure(rows[2], "maps"), 1024);
}

TEST(GuidingBench, NeedsARadianceDecoder) {
  const test::TempDir folder;
  scene::write_glb(folder / "room.glb", test::furnished_room());
  test::save_tiny_model(folder / "m.safetensors");
  BenchOptions options;
  options.scene = (folder / "room.glb").string();
  options.checkpoint = (folder / "m.safetensors").string();
  try {
    bench_guiding(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no radiance decoder"));
  }
}

}  // namespace
}  // namespace lte::infer
