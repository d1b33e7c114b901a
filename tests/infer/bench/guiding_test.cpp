// lte_bench guiding: ways to draw paths, of one mean.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/bench/bench.h"
#include "lte/base/check.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

TEST(GuidingBench, AllWaysOfDrawingHaveOneMean) {
  const test::TempDir folder;
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.3f;
  scene::write_glb(folder / "room.glb", scene);
  test::save_tiny_model(folder / "m.safetensors", {.radiance_lobes = 4, .gloss = true});
  BenchOptions options;
  options.scene = (folder / "room.glb").string();
  options.checkpoint = (folder / "m.safetensors").string();
  const std::vector<BenchResult> rows = bench_guiding(options);
  ASSERT_EQ(rows.size(), 3u);
  const BenchResult &plain = rows[0], &lights = rows[1], &guided = rows[2];
  // An untrained guide is no better, and no worse than its share.
  const double mean = plain.figures.at("mean");
  EXPECT_GT(mean, 0);
  EXPECT_NEAR(guided.figures.at("mean"), mean, 0.02 * mean);
  const double variance = plain.figures.at("relative_variance_8");
  EXPECT_NEAR(plain.figures.at("relative_variance_2"), 4 * variance, 1e-6 * variance);
  EXPECT_LT(guided.figures.at("relative_variance_8"), 4 * variance);
  EXPECT_EQ(lights.figures.at("relative_variance_8"), variance) << "the same paths";
  // Lamps bring the same whether paths meet them or samples find them.
  const double whole = plain.figures.at("whole_mean");
  EXPECT_GT(whole, 1.05 * mean);
  EXPECT_NEAR(lights.figures.at("whole_mean"), whole, 0.05 * whole);
  EXPECT_NEAR(guided.figures.at("whole_mean"), whole, 0.05 * whole);
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
