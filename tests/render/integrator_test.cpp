// Integrators against closed forms: a furnace, a panel, darkness.
#include "lte/render/integrator.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/render/scenes.h"

namespace lte::render {
namespace {

constexpr float kAlbedo = 0.5f, kRadiance = 2;

std::vector<Vec3> repeated(const Vec3& value, size_t count) { return {count, value}; }

Rgb mean(const std::vector<Rgb>& values) {
  Rgb sum;
  for (const Rgb& value : values) sum += value;
  return sum * (1 / static_cast<float>(values.size()));
}

PointIrradiance at(const Integrator& integrator, const Vec3& position, const Vec3& normal,
                   const PointSampling& sampling, size_t count = 64) {
  return integrator.irradiance({repeated(position, count), repeated(normal, count)}, sampling);
}

/// Of depth `bounces` + 1: E = pi L (1 + a + a² + ...), of which the first term is direct.
float furnace_indirect(int bounces) {
  float sum = 0, term = kPi * kRadiance;
  for (int k = 0; k < bounces; ++k) sum += term *= kAlbedo;
  return sum;
}

TEST(Gather, InAFurnaceIrradianceIsTheSumOfItsBounces) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  for (const int depth : {2, 5}) {
    CacheSettings settings;
    settings.records = 256;
    settings.paths = 64;
    settings.max_depth = depth;
    const auto gather = make_gather(room.view(), settings);
    gather->prepare();
    EXPECT_EQ(gather->method(), Method::Gather);
    const PointIrradiance light = at(*gather, {1, 0, 1}, {0, 1, 0}, {16, 16, 0, 0});
    EXPECT_NEAR(mean(light.direct).x, kPi * kRadiance, 0.02f * kPi * kRadiance);
    EXPECT_NEAR(mean(light.indirect).y, furnace_indirect(depth - 1),
                0.03f * furnace_indirect(depth - 1));
  }
}

TEST(Path, InAFurnaceIrradianceIsTheSumOfItsBounces) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  const auto path = make_path(room.view(), 5);
  path->prepare();
  const PointIrradiance light = at(*path, {1, 0, 1}, {0, 1, 0}, {64, 64, 3, 0}, 256);
  EXPECT_NEAR(mean(light.direct).x, kPi * kRadiance, 0.02f * kPi * kRadiance);
  EXPECT_NEAR(mean(light.indirect).z, furnace_indirect(4), 0.02f * furnace_indirect(4));
}

TEST(Gather, ANetworksLightTakesItsLevelFromTheScene) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  const float indirect = 30;  // of any level
  CacheSettings settings;
  settings.records = 256;
  settings.paths = 64;
  size_t records = 0;
  const auto network =
      make_gather(room.view(), settings,
                  [&](std::span<const Vec3> positions, std::span<const Vec3> normals,
                      std::span<const Rgb> albedos) {
                    records = positions.size();
                    EXPECT_EQ(normals.size(), records);
                    EXPECT_EQ(albedos.front(), (Rgb{kAlbedo, kAlbedo, kAlbedo}));
                    return std::vector<Rgb>(records, {indirect, indirect, indirect});
                  });
  network->prepare();
  EXPECT_EQ(network->method(), Method::Network);
  EXPECT_NEAR(static_cast<double>(records), 256, 32) << "the sides that light reaches";
  const PointIrradiance light = at(*network, {1, 0, 1}, {0, 1, 0}, {32, 32, 0, 0});
  const float expected = furnace_indirect(settings.max_depth - 1);
  EXPECT_NEAR(mean(light.indirect).x, expected, 0.03f * expected);
}

/// In a furnace a normal that leans by θ loses what lies below the surface: (1 + cos θ) / 2 of the
/// light is left.
TEST(Integrators, AShadingNormalSeesWhatIsAboveTheSurface) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  CacheSettings settings;
  settings.records = 256;
  settings.paths = 64;
  const auto gather = make_gather(room.view(), settings), path = make_path(room.view(), 5);
  const Vec3 leaning = normalize({1, 1, 0});
  const std::vector<Vec3> position(256, {1, 0, 1}), shading(256, leaning),
      geometric(256, {0, 1, 0});
  const float left = (1 + leaning.y) / 2;
  for (Integrator* const integrator : {gather.get(), path.get()}) {
    integrator->prepare();
    const PointIrradiance light =
        integrator->irradiance({position, shading, geometric}, {16, 16, 0, 0});
    EXPECT_NEAR(mean(light.direct).x, left * kPi * kRadiance, 0.02f * kPi * kRadiance);
    EXPECT_NEAR(mean(light.indirect).y, left * furnace_indirect(4), 0.03f * furnace_indirect(4));
  }
}

/// Where every wall leans so, each bounce loses that share.
TEST(Gather, BumpyWallsReflectWhatTheirShadingNormalsSee) {
  scene::Scene box = test::furnace(kAlbedo, kRadiance);
  scene::Material& wall = box.materials.front();
  wall.normal_texture.texture = 0;
  box.textures = {std::make_shared<const scene::Texture>(
      1, 1, std::vector<uint8_t>{255, 128, 191}, /*srgb=*/false)};  // 63 degrees off the wall
  const test::Traced room(std::move(box));
  const Vec3 normal = normalize({2 * 127.0f / 255, 0, 2 * 191.0f / 255 - 1});
  const float passed = kAlbedo * (1 + normal.z) / 2;
  float expected = 0, term = kPi * kRadiance;
  for (int k = 0; k < 4; ++k) expected += term *= passed;
  CacheSettings settings;
  settings.records = 256;
  settings.paths = 64;
  const auto gather = make_gather(room.view(), settings), path = make_path(room.view(), 5);
  for (Integrator* const integrator : {gather.get(), path.get()}) {
    integrator->prepare();
    const PointIrradiance light = at(*integrator, {1, 0, 1}, {0, 1, 0}, {16, 16, 0, 0}, 256);
    EXPECT_NEAR(mean(light.indirect).y, expected, 0.03f * expected);
  }
}

TEST(Gather, ASourceOfAnotherLengthIsRefused) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  EXPECT_THROW(make_cache(room.view(), {}, [](auto, auto, auto) { return std::vector<Rgb>(3); }),
               Error);
}

TEST(Integrators, UnderAPanelDirectLightIsItsFormFactor) {
  const test::Traced floor(test::panel_over_floor(0.5f, kRadiance));
  // Of a square of edge 2 at distance 1, from below its middle: four corners of 1 x 1.
  const float side = 1 / std::sqrt(2.0f);
  const float corner = 2 * side * std::atan(side) / (2 * kPi);
  const float expected = kPi * kRadiance * 4 * corner;
  const auto path = make_path(floor.view(), 5);
  const PointIrradiance light = at(*path, {0, 0, 0}, {0, 1, 0}, {16, 16, 1, 0}, 256);
  EXPECT_NEAR(mean(light.direct).x, expected, 0.02f * expected);
  EXPECT_EQ(mean(light.indirect).x, 0) << "nothing reflects light onto the floor";
}

TEST(Integrators, WithoutLightAllIsDark) {
  scene::Scene scene;
  test::add_instance(
      &scene, test::box_mesh({0, 0, 0}, {2, 2, 2}, test::add_material(&scene, {1, 1, 1}), true));
  const test::Traced room(std::move(scene));
  for (const bool gathers : {false, true}) {
    const auto integrator =
        gathers ? make_gather(room.view(), CacheSettings{}) : make_path(room.view(), 5);
    integrator->prepare();
    const PointIrradiance light = at(*integrator, {1, 0, 1}, {0, 1, 0}, {4, 4, 0, 0}, 8);
    EXPECT_EQ(mean(light.direct) + mean(light.indirect), Rgb{});
  }
}

TEST(Integrators, APointsLightDependsOnItsStreamAlone) {
  const test::Traced room(test::furnished_room());
  CacheSettings settings;
  settings.records = 512;
  const auto gather = make_gather(room.view(), settings);
  gather->prepare();
  std::vector<Vec3> position, normal;
  for (int i = 0; i < 100; ++i) {
    position.push_back({0.5f + 0.02f * static_cast<float>(i), 0, 1.5f});
    normal.push_back({0, 1, 0});
  }
  const PointIrradiance all = gather->irradiance({position, normal}, {2, 2, 7, 0});
  const std::span<const Vec3> p(position), n(normal);
  const PointIrradiance tail = gather->irradiance({p.subspan(60), n.subspan(60)}, {2, 2, 7, 60});
  for (size_t i = 0; i < tail.direct.size(); ++i) {
    EXPECT_EQ(tail.direct[i], all.direct[60 + i]);
    EXPECT_EQ(tail.indirect[i], all.indirect[60 + i]);
  }
}

TEST(Gather, BeforeItsCacheIsMadeIsAnError) {
  const test::Traced room(test::furnace(kAlbedo, kRadiance));
  const auto gather = make_gather(room.view(), CacheSettings{});
  EXPECT_THROW(at(*gather, {1, 0, 1}, {0, 1, 0}, {1, 1, 0, 0}, 1), Error);
}

}  // namespace
}  // namespace lte::render
