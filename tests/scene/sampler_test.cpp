#include "lte/scene/sampler.h"

#include <cmath>
#include <map>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/parallel.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

SamplerOptions plain(uint64_t seed = 1) {
  SamplerOptions options;
  options.seed = seed;
  return options;
}

/// n quads of areas 1, 2, 3, ... in a row along x, at heights z = 0, 1, 2, ...
Scene staircase(int n) {
  Scene scene;
  test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  for (int i = 0; i < n; ++i) {
    const auto z = static_cast<float>(i);
    test::add_quad(&scene, {0, 0, z}, {z + 1, 0, 0}, {0, 1, 0}, 0);
  }
  return scene;
}

/// A 10 m² floor, not emissive, and a 0.0001 m² light.
Scene small_light() {
  Scene scene;
  test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_material(&scene, {0, 0, 0}, {7, 7, 7});
  test::add_quad(&scene, {0, 0, 0}, {10, 0, 0}, {0, 1, 0}, 0);
  test::add_quad(&scene, {0, 0, 1}, {0.01f, 0, 0}, {0, 0.01f, 0}, 1);
  return scene;
}

double sum(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Sampler, GivesExactlyTheCountAndTheWholeArea) {
  const Scene scene = staircase(4);
  EXPECT_NEAR(surface_area(scene), 10, 1e-6);
  for (const int64_t count : {1, 2, 3, 100, 4097}) {
    const SurfaceSamples samples = sample_surface(scene, count, plain());
    ASSERT_EQ(samples.size(), count);
    EXPECT_EQ(samples.normal.size(), samples.position.size());
    EXPECT_NEAR(sum(samples.area), 10, 1e-3);
  }
}

TEST(Sampler, CountsFollowAreasToWithinOne) {
  const SurfaceSamples samples = sample_surface(staircase(4), 1000, plain());
  std::array<int, 4> counts{};
  for (const Vec3& p : samples.position) ++counts.at(static_cast<size_t>(std::lround(p.z)));
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(counts[i], 100.0 * static_cast<double>(i + 1), 1.0);
}

TEST(Sampler, CountsATriangleOnceHoweverOftenItStandsThere) {
  Scene scene = staircase(2), once = scene;
  // The first quad, of 1 of 3 m², nine times more: in its mesh, turned by one corner, and moved to
  // its place from somewhere else.
  Mesh& mesh = scene.meshes[0];
  const auto triangles = mesh.triangles;
  for (int i = 0; i < 8; ++i)
    for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({b, c, a});
  test::add_instance(&scene, test::quad_mesh({4, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0),
                     test::translation({-4, 0, 0}));
  EXPECT_NEAR(surface_area(scene), 12, 1e-6);
  for (const double share : {0.0, 0.1}) {
    SamplerOptions options = plain();
    options.emissive_share = share;
    const SurfaceSamples samples = sample_surface(scene, 999, options);
    EXPECT_NEAR(sum(samples.area), 3, 1e-3);
    int low = 0;
    for (const Vec3& p : samples.position) low += p.z < 0.5f ? 1 : 0;
    EXPECT_NEAR(low, 333, 1);
    const SurfaceSamples plain_samples = sample_surface(once, 999, options);
    EXPECT_EQ(samples.position, plain_samples.position) << "as if they were not there";
  }
}

TEST(Sampler, CountsBothSidesOfASheetAndEachOfTwoLamps) {
  Scene scene = staircase(1);
  Mesh back = scene.meshes[0];
  for (auto& triangle : back.triangles) std::swap(triangle[0], triangle[1]);
  test::add_instance(&scene, back);
  EXPECT_NEAR(sum(sample_surface(scene, 10, plain()).area), 2, 1e-5);
  Scene lamps = small_light();
  test::add_quad(&lamps, {0, 0, 1}, {0.01f, 0, 0}, {0, 0.01f, 0}, 1);
  EXPECT_NEAR(sum(sample_surface(lamps, 10, plain()).area), 10.0002, 1e-5);
}

TEST(Sampler, IsUniformOnATriangle) {
  // 16 congruent sub-triangles by a 4 x 4 subdivision: chi-square over independent runs of few
  // points each, so that stratification cannot hide a bias. 15 degrees of freedom: 99.9 % quantile
  // 37.7.
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  Mesh mesh = test::quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  mesh.triangles.resize(1);
  mesh.positions[2] = {0, 1, 0};
  test::add_instance(&scene, mesh);
  std::map<std::array<int, 3>, int> cells;
  constexpr int kRuns = 16000;
  for (int run = 0; run < kRuns; ++run) {
    const Vec3 p = sample_surface(scene, 1, plain(static_cast<uint64_t>(run))).position[0];
    ASSERT_TRUE(p.x >= 0 && p.y >= 0 && p.x + p.y <= 1);
    ++cells[{static_cast<int>(4 * p.x), static_cast<int>(4 * p.y),
             static_cast<int>(4 * (p.x + p.y))}];
  }
  ASSERT_EQ(cells.size(), 16u);
  double chi2 = 0;
  for (const auto& [cell, n] : cells)
    chi2 += (n - kRuns / 16.0) * (n - kRuns / 16.0) / (kRuns / 16.0);
  EXPECT_LT(chi2, 37.7);
}

TEST(Sampler, StrataFillTheSurfaceEvenly) {
  // 4096 points on a square: no 8 x 8 cell (64 expected) may stray as far as independent points do
  // (8 = one sigma).
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  std::array<int, 64> cells{};
  for (const Vec3& p : sample_surface(scene, 4096, plain()).position) {
    ++cells.at(static_cast<size_t>(8 * p.x) + 8 * static_cast<size_t>(8 * p.y));
  }
  double variance = 0;
  for (const int n : cells) variance += (n - 64.0) * (n - 64.0) / 64;
  EXPECT_LT(variance, 64 / 4.0);
}

TEST(Sampler, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = test::furnished_room();
  const int before = num_threads();
  SamplerOptions options = plain(9);
  options.emissive_share = 0.1;
  set_num_threads(1);
  const SurfaceSamples one = sample_surface(scene, 20000, options);
  set_num_threads(7);
  const SurfaceSamples seven = sample_surface(scene, 20000, options);
  set_num_threads(before);
  EXPECT_EQ(one.position, seven.position);
  EXPECT_EQ(one.emission, seven.emission);
  EXPECT_EQ(one.area, seven.area);
}

TEST(Sampler, SeedsGiveOtherPoints) {
  const Scene scene = staircase(1);
  EXPECT_NE(sample_surface(scene, 10, plain(1)).position,
            sample_surface(scene, 10, plain(2)).position);
}

TEST(Sampler, GuaranteesItsShareToEmitters) {
  SamplerOptions options = plain();
  options.emissive_share = 0.05;
  const SurfaceSamples samples = sample_surface(small_light(), 1000, options);
  int lit = 0;
  double lit_area = 0;
  for (size_t i = 0; i < samples.position.size(); ++i) {
    const bool on_light = samples.position[i].z > 0.5f;
    EXPECT_EQ(samples.light_group[i], on_light ? 0 : kNone);
    EXPECT_EQ(samples.emission[i].x, on_light ? 7.0f : 0.0f);
    lit += on_light ? 1 : 0;
    lit_area += on_light ? samples.area[i] : 0;
  }
  EXPECT_EQ(lit, 50);
  EXPECT_NEAR(lit_area, 1e-4, 1e-9);
  EXPECT_NEAR(sum(samples.area), 10.0001, 1e-4);
}

TEST(Sampler, ShareBelowTheAreasOwnChangesNothing) {
  const Scene scene = staircase(2);
  SamplerOptions options = plain();
  options.emissive_share = 0.3;
  Scene lit = scene;
  lit.materials[0].emission = {1, 1, 1};
  EXPECT_EQ(sample_surface(lit, 100, options).position, sample_surface(lit, 100, plain()).position);
  EXPECT_EQ(sample_surface(scene, 100, options).position,
            sample_surface(scene, 100, plain()).position);
}

TEST(Sampler, NeverPicksATriangleWithoutArea) {
  Scene scene = staircase(1);
  Mesh& mesh = scene.meshes[0];
  mesh.positions.push_back({50, 50, 50});
  mesh.triangles.insert(mesh.triangles.begin(), {4, 4, 4});
  mesh.triangles.push_back({4, 4, 4});
  for (const Vec3& p : sample_surface(scene, 1000, plain()).position) EXPECT_LE(p.x, 1);
}

TEST(Sampler, MirroredInstancesKeepTheirNormals) {
  Scene scene;
  test::add_material(&scene, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, 0, false),
                     test::scaling({-1, 1, 1}));
  const SurfaceSamples samples = sample_surface(scene, 500, plain());
  for (size_t i = 0; i < 500; ++i)
    EXPECT_NEAR(dot(samples.normal[i], samples.position[i]), 1, 1e-5);
}

TEST(Sampler, PointLightBecomesTwoSamplesOfEqualPower) {
  Scene scene = staircase(4);
  test::add_point_light(&scene, {1, 2, 3}, {5, 0, 1});
  PunctualLight spot = scene.lights[0];
  spot.kind = LightKind::Spot;
  spot.direction = {0, -1, 0};
  spot.inner_cone = spot.outer_cone = kPi / 3;  // a hard cone of solid angle pi
  spot.light_group = 1;
  PunctualLight sun = scene.lights[0];
  sun.kind = LightKind::Directional;
  scene.lights.insert(scene.lights.end(), {spot, sun});

  const SurfaceSamples samples = sample_surface(scene, 104, plain());
  ASSERT_EQ(samples.size(), 104);  // 100 of surfaces, and the sun last
  EXPECT_EQ(samples.position[100], (Vec3{1, 2, 3}));
  const auto power = [&](size_t i) { return samples.emission[i] * (kPi * samples.area[i]); };
  EXPECT_EQ(samples.position[101], samples.position[100]);
  EXPECT_EQ(samples.normal[101], -samples.normal[100]);
  for (const size_t i : {100, 101}) {
    EXPECT_NEAR(power(i).x, 2 * kPi * 5, 1e-3);
    EXPECT_NEAR(power(i).z, 2 * kPi, 1e-3);
    EXPECT_EQ(samples.light_group[i], 0);
    EXPECT_NEAR(samples.area[i], 10.0 / 103, 1e-6);
  }
  EXPECT_NEAR(power(102).x, kPi * 5, 1e-3);
  EXPECT_EQ(samples.normal[102], (Vec3{0, -1, 0}));
  EXPECT_EQ(samples.light_group[102], 1);

  SamplerOptions without = plain();
  without.punctual_lights = false;
  for (const Rgb& emission : sample_surface(scene, 102, without).emission)
    EXPECT_EQ(emission, Rgb{});
}

TEST(Sampler, SpotPowerIsTheIntegralOfItsFalloff) {
  Scene scene = staircase(1);
  test::add_point_light(&scene, {0, 0, 5}, {2, 2, 2});
  PunctualLight& spot = scene.lights[0];
  spot.kind = LightKind::Spot;
  spot.inner_cone = 0.3f;
  spot.outer_cone = 0.9f;
  double integral = 0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = (i + 0.5) / kSteps;
    const double ramp =
        std::clamp((cosine - std::cos(0.9)) / (std::cos(0.3) - std::cos(0.9)), 0.0, 1.0);
    integral += 2 * M_PI * 2 * ramp * ramp / kSteps;
  }
  const SurfaceSamples samples = sample_surface(scene, 2, plain());
  EXPECT_NEAR(samples.emission[1].x * M_PI * samples.area[1], integral, 1e-3);
}

TEST(Sampler, FootprintAveragesTextures) {
  Scene scene = staircase(1);
  std::vector<uint8_t> texels;
  for (int i = 0; i < 64 * 64; ++i) texels.insert(texels.end(), 3, (i + i / 64) % 2 == 0 ? 255 : 0);
  scene.textures.push_back(std::make_shared<const Texture>(64, 64, texels, true));
  scene.materials[0].base_color = {1, 1, 1};
  scene.materials[0].base_color_texture.texture = 0;
  const SurfaceSamples coarse = sample_surface(scene, 16, plain());  // 0.25 m or 16 texels each
  for (const Rgb& albedo : coarse.albedo) EXPECT_NEAR(albedo.x, 0.5, 1e-4);
  SamplerOptions options = plain();
  options.filter_footprint = false;
  double spread = 0;
  for (const Rgb& albedo : sample_surface(scene, 256, options).albedo)
    spread += std::abs(albedo.x - 0.5) / 256;
  EXPECT_GT(spread, 0.1);
}

TEST(Sampler, RefusesWhatCannotBeSampled) {
  Scene empty;
  empty.name = "void";
  empty.materials.emplace_back();
  EXPECT_THAT(test::error_of([&] { sample_surface(empty, 10, {}); }), ::testing::HasSubstr("void"));
  Scene scene = staircase(1);
  EXPECT_THAT(test::error_of([&] { sample_surface(scene, 0, {}); }),
              ::testing::HasSubstr("at least 1"));
  test::add_point_light(&scene, {0, 0, 0}, {1, 1, 1});
  EXPECT_THAT(test::error_of([&] { sample_surface(scene, 1, {}); }),
              ::testing::HasSubstr("punctual lights"));
  SamplerOptions options;
  options.emissive_share = 1;
  EXPECT_THAT(test::error_of([&] { sample_surface(scene, 9, options); }),
              ::testing::HasSubstr("emissive_share"));
}

/// A 10 m² floor and a sheet of `edge`² m² that emits from both sides.
Scene two_sided_light(float edge) {
  Scene scene;
  test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_material(&scene, {0, 0, 0}, {7, 7, 7}, /*double_sided=*/true);
  test::add_quad(&scene, {0, 0, 0}, {10, 0, 0}, {0, 1, 0}, 0);
  test::add_quad(&scene, {0, 0, 1}, {edge, 0, 0}, {0, edge, 0}, 1);
  return scene;
}

TEST(Sampler, ASheetThatEmitsFromBothSidesHasPointsOnEitherOfItsWholePower) {
  SamplerOptions options = plain();
  options.emissive_share = 0.1;
  for (const float edge : {2.0f, 0.3f, 0.01f}) {
    for (const int64_t count : {40, 1000}) {
      const SurfaceSamples samples = sample_surface(two_sided_light(edge), count, options);
      ASSERT_EQ(samples.size(), count);
      std::array<double, 2> area{};
      for (size_t i = 0; i < samples.position.size(); ++i) {
        if (samples.light_group[i] == kNone) continue;
        EXPECT_NEAR(samples.position[i].z, 1, 1e-6);
        EXPECT_EQ(samples.emission[i], (Rgb{7, 7, 7}));
        area.at(samples.normal[i].z > 0 ? 0 : 1) += double{samples.area[i]};
      }
      // Strata meet a face to within one.
      const double slack =
          edge == 0.01f ? 1e-9 : 2.0 * edge * edge / (0.05 * static_cast<double>(count));
      EXPECT_NEAR(area[0], edge * edge, slack) << edge << " m, " << count << " points";
      EXPECT_NEAR(area[1], edge * edge, slack) << edge << " m, " << count << " points";
    }
  }
  const SurfaceSamples queries = sample_surface(two_sided_light(2), 1000, plain());
  for (size_t i = 0; i < queries.position.size(); ++i) EXPECT_GT(queries.normal[i].z, 0);
}

}  // namespace
}  // namespace lte::scene
