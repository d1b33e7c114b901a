// lte_bench guiding: two ways to draw paths, of one mean.
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

TEST(GuidingBench, BothWaysOfDrawingHaveOneMean) {
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
  ASSERT_EQ(rows.size(), 2u);
  // An untrained guide is no better, and no worse than its share.
  const double mean = rows[0].figures.at("mean");
  EXPECT_GT(mean, 0);
  EXPECT_NEAR(rows[1].figures.at("mean"), mean, 0.02 * mean);
  const double plain = rows[0].figures.at("relative_variance_8"),
               guided = rows[1].figures.at("relative_variance_8");
  EXPECT_NEAR(rows[0].figures.at("relative_variance_2"), 4 * plain, 1e-6 * plain);
  EXPECT_LT(guided, 4 * plain);
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
