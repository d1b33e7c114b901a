// Baselines at equal paths: the light that the network reads, a denoiser, and the picture combined
// from network and denoised paths.
#include "infer/eval/measure/network_and_paths.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "infer/eval/baselines/denoised_paths.h"
#include "lte/base/random.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/points.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

runtime::Network network_reading(nn::LightInput input, const test::TempDir& folder) {
  test::TinyModel tiny;
  tiny.light_input = input;
  test::save_tiny_model(folder / "model.safetensors", tiny);
  return runtime::Network(folder / "model.safetensors");
}

runtime::ScenePoints points_of(const data::SceneSample& sample) {
  return {sample.scene_position, sample.scene_normal, sample.scene_albedo, sample.scene_emission,
          sample.scene_area};
}

TEST(CachedLight, OfEqualEstimatesIsTheirValueWhateverTheNetwork) {
  const test::TempDir folder;
  const data::SceneSample sample = test::random_sample("room", 1);
  runtime::ScenePoints points = points_of(sample);
  const std::vector<Rgb> light(sample.scene_position.size(), Rgb{2, 3, 4});
  const std::vector<Rgb> dark(light.size());
  const std::vector<float> exact(2 * light.size());
  points.direct = points.indirect = light;
  points.direct_back = points.indirect_back = dark;
  points.indirect_error = exact;
  const runtime::Network network = network_reading(nn::LightInput::Traced, folder);
  const std::vector<Rgb> found = runtime::SceneEmbedding(network, points)
                                     .light_prior({points.position, points.normal, points.albedo});
  ASSERT_EQ(found.size(), light.size());
  for (const Rgb& value : found) {  // the cache adds 2 % of the mean everywhere
    EXPECT_NEAR(value.x, 2 * 1.02, 0.01);
    EXPECT_NEAR(value.y, 3 * 1.02, 0.015);
    EXPECT_NEAR(value.z, 4 * 1.02, 0.02);
  }
}

TEST(CachedLight, IsNothingWhereTheNetworkIsGivenNone) {
  const test::TempDir folder;
  const data::SceneSample sample = test::random_sample("room", 1);
  const runtime::ScenePoints points = points_of(sample);
  const runtime::Network network = network_reading(nn::LightInput::Emission, folder);
  EXPECT_TRUE(runtime::SceneEmbedding(network, points)
                  .light_prior({points.position, points.normal, points.albedo})
                  .empty());
}

TEST(DenoisedPaths, TakesNoiseFromAWallAndKeepsTheOrderOfItsPixels) {
  data::View view;
  view.width = 48;
  view.height = 32;
  const Vec3 normals[] = {{0, 0, 1}, {1, 0, 0}};  // of the left half and of the right
  const float light[] = {1, 4};
  Rng rng(3);
  std::vector<Rgb> truth, noisy;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const bool seen = y > 1;
      const int side = x < 24 ? 0 : 1;
      view.mask.push_back(seen);
      view.normal.push_back(seen ? normals[side] : Vec3{});
      view.position.push_back(
          seen ? Vec3{0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 5.0f * side}
               : Vec3{});
      if (!seen) continue;
      truth.push_back(Rgb{1, 1, 1} * light[side]);
      noisy.push_back(truth.back() * (2 * rng.uniform()));
    }
  }
  const auto error = [&](const std::vector<Rgb>& values) {
    double sum = 0;
    for (size_t i = 0; i < values.size(); ++i) sum += std::pow(values[i].x - truth[i].x, 2);
    return sum / static_cast<double>(values.size());
  };
  for (const image::DenoiseBy by : {image::DenoiseBy::Best, image::DenoiseBy::Bilateral}) {
    const std::vector<Rgb> clean = denoised_paths(image::Denoiser(by), view, noisy);
    ASSERT_EQ(clean.size(), truth.size());
    EXPECT_LT(error(clean), 0.2 * error(noisy));
  }
}

/// A view of 9 x 7 pixels, of which some in the middle and a corner see nothing.
data::View view_with_holes() {
  data::View view;
  view.width = 9;
  view.height = 7;
  view.mask.assign(63, 1);
  for (const size_t hole : {0u, 30u, 31u, 40u}) view.mask[hole] = 0;
  return view;
}

TEST(Combine, WeighsPathsByTheirNumber) {
  const data::View view = view_with_holes();
  std::vector<Rgb> network, clean;
  Rng rng(5);
  for (int i = 0; i < 59; ++i) {
    network.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
    clean.push_back(network.back() + Rgb{3, 0, 1});
  }
  for (const int paths : {1, 2, 14}) {
    const float share = static_cast<float>(paths) / static_cast<float>(paths + 2);
    const std::vector<Rgb> both = combine(view, network, clean, paths);
    ASSERT_EQ(both.size(), network.size());
    for (size_t i = 0; i < both.size(); ++i) {
      EXPECT_NEAR(both[i].x, network[i].x + 3 * share, 1e-5);
      EXPECT_NEAR(both[i].y, network[i].y, 1e-5);
      EXPECT_NEAR(both[i].z, network[i].z + share, 1e-5);
    }
  }
}

TEST(Combine, KeepsTheNetworksDetail) {
  data::View view = view_with_holes();
  view.mask.assign(63, 1);
  std::vector<Rgb> network, clean;
  for (int i = 0; i < 63; ++i) {  // in rows of odd length a chessboard
    network.push_back({5, 5, 5});
    clean.push_back(i % 2 == 0 ? Rgb{9, 9, 9} : Rgb{1, 1, 1});
  }
  const std::vector<Rgb> both = combine(view, network, clean, 64);
  for (int y = 1; y < 6; ++y) {
    for (int x = 1; x < 8; ++x) EXPECT_NEAR(both[static_cast<size_t>(9 * y + x)].x, 5, 1e-5);
  }
}

TEST(Combine, IsNotNegativeAndRefusesPicturesOfDifferentSizes) {
  const data::View view = view_with_holes();
  std::vector<Rgb> network(59, Rgb{1, 1, 1}), clean(59);
  network[20] = {};
  for (const Rgb& value : combine(view, network, clean, 64)) {
    EXPECT_GE(value.x, 0);
    EXPECT_LT(value.x, 1);
  }
  clean.pop_back();
  EXPECT_THROW(combine(view, network, clean, 64), Error);
}

}  // namespace
}  // namespace lte::infer
