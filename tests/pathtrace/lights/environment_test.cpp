// Light of environments against closed forms, quadrature and a path tracer that shares no code.
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/surface.h"
#include "tests/support/closed_forms.h"
#include "tests/support/naive_path_tracer.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using scene::Environment;
using scene::EnvironmentMap;
using scene::SphereMapping;
using test::add_instance;
using test::add_material;
using test::add_quad;

void set_sky(scene::Scene* scene, Environment environment) {
  scene->environment = std::move(environment);
  scene::add_environment_group(scene);
}

Environment constant(const Rgb& radiance) {
  Environment out;
  out.radiance = radiance;
  return out;
}

Environment with_map(const image::Image& image, SphereMapping mapping) {
  Environment out = constant({1, 1, 1});
  out.map = std::make_shared<const EnvironmentMap>(image, mapping);
  return out;
}

/// White above the horizon, black below.
Environment half_sky(float radiance) {
  image::Image image(2, 2, 3);
  for (int x = 0; x < 2; ++x) image.set_rgb(x, 0, {radiance, radiance, radiance});
  return with_map(image, SphereMapping::Equirectangular);
}

/// A picture of random texels over four decades, some of them black.
Environment noise(SphereMapping mapping, uint64_t seed) {
  const int width = mapping == SphereMapping::EqualArea ? 16 : 24, height = 16;
  image::Image image(width, height, 3);
  Rng rng(seed);
  for (float& value : image.pixels)
    value = rng.below(4) == 0 ? 0 : std::pow(10.0f, rng.uniform(-2, 2));
  Environment out = with_map(image, mapping);
  const Affine turn = test::rotation(normalize({1, 2, 3}), 1.1f);
  out.axes = {turn.vector({1, 0, 0}), turn.vector({0, 1, 0}), turn.vector({0, 0, -1})};
  return out;
}

Irradiance irradiance(const scene::Scene& scene, const std::vector<Vec3>& positions,
                      const std::vector<Vec3>& normals, int rays, int max_depth = 5) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  IrradianceOptions options;
  options.rays = rays;
  options.max_depth = max_depth;
  options.seed = 3;
  return estimate_irradiance(bvh, lights, positions, normals, options);
}

scene::Scene plane(float albedo = 0.5f) {
  scene::Scene scene;
  const int material = add_material(&scene, {albedo, albedo, albedo});
  add_quad(&scene, {-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, material);  // z × x = y
  return scene;
}

TEST(EnvironmentLight, ConstantSkyGivesPiTimesItsRadiance) {
  scene::Scene scene = plane();
  set_sky(&scene, constant({1, 2, 3}));
  for (const Vec3& normal : {Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
    const Irradiance e = irradiance(scene, {{0, 0, 0}}, {normal}, 64);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(e.total(0)[c], kPi * static_cast<float>(c + 1), 1e-4f);
      EXPECT_EQ(e.indirect_sum(0)[c], 0) << "light from the environment itself has depth 1";
    }
  }
}

/// A point above the plane that leans by β sees π L (1 + cos β) / 2 of the sky and the rest of the
/// plane below, which reflects ρ π L: (1 − cos β) / 2 of it, if it is endless.
TEST(EnvironmentLight, HalfASkyOverAPlane) {
  scene::Scene scene;
  add_quad(&scene, {-1e4f, 0, -1e4f}, {0, 0, 2e4f}, {2e4f, 0, 0},
           add_material(&scene, {0.6f, 0.6f, 0.6f}));
  set_sky(&scene, half_sky(2));
  for (const float beta : {0.0f, 0.7f, 1.5707964f, 2.5f}) {
    const Irradiance e =
        irradiance(scene, {{0, 1, 0}}, {{std::sin(beta), std::cos(beta), 0}}, 16384);
    const double sky = M_PI * 2 * (1 + std::cos(beta)) / 2;
    const double ground = M_PI * 0.6 * 2 * (1 - std::cos(beta)) / 2;
    const double error = 4.5 * std::sqrt(e.variance_total[0].x) + 1e-3;
    EXPECT_NEAR(e.direct_sum(0).x, sky, error) << beta;
    EXPECT_NEAR(e.indirect_sum(0).x, ground, error) << beta;
  }
}

/// A black box whose fourth wall is missing: what comes in is the opening's share.
TEST(EnvironmentLight, AnOpenBoxSeesTheShareOfItsOpening) {
  scene::Scene scene;
  scene::Mesh box = test::box_mesh({0, 0, 0}, {2, 1, 3}, add_material(&scene, {0, 0, 0}), true);
  box.triangles.erase(box.triangles.begin() + 2, box.triangles.begin() + 4);  // that at x = 2
  add_instance(&scene, std::move(box));
  set_sky(&scene, constant({4, 4, 4}));
  // Past the horizons of floor and ceiling, where the closed form cuts it off.
  constexpr float kLow = -1e-6f, kHigh = 1 + 1e-6f;
  const std::vector<Vec3> opening{{2, kLow, 0}, {2, kHigh, 0}, {2, kHigh, 3}, {2, kLow, 3}};
  const std::vector<Vec3> positions{{0.5f, 0, 1}, {1.9f, 0, 2}, {0, 0.5f, 1.5f}, {1, 1, 0.2f}};
  const std::vector<Vec3> normals{{0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, -1, 0}};
  for (const bool picture : {false, true}) {
    if (picture) {
      image::Image white(8, 4, 3);
      for (float& value : white.pixels) value = 4;
      const int group = scene.environment->light_group;
      scene.environment = with_map(white, SphereMapping::Equirectangular);
      scene.environment->light_group = group;
    }
    const Irradiance e = irradiance(scene, positions, normals, 16384);
    for (size_t i = 0; i < positions.size(); ++i) {
      const double expected = 4 * test::polygon_irradiance(opening, positions[i], normals[i]);
      EXPECT_NEAR(e.total(static_cast<int64_t>(i)).x, expected,
                  4.5 * std::sqrt(e.variance_total[i].x) + 1e-4 * expected)
          << i;
    }
  }
}

/// Everything white: radiance is L wherever light gets at all, after enough bounces.
TEST(EnvironmentLight, WhiteSurfacesUnderAConstantSkyVanish) {
  scene::Scene scene;
  scene::Mesh box = test::box_mesh({0, 0, 0}, {1, 1, 1}, add_material(&scene, {1, 1, 1}), true);
  box.triangles.erase(box.triangles.begin() + 2, box.triangles.begin() + 4);
  add_instance(&scene, std::move(box));
  set_sky(&scene, constant({1, 1, 1}));
  const Irradiance e =
      irradiance(scene, {{0.3f, 0, 0.6f}, {0, 0.2f, 0.1f}}, {{0, 1, 0}, {1, 0, 0}}, 2048, 200);
  for (size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(e.total(static_cast<int64_t>(i)).x, kPi,
                4.5 * std::sqrt(e.variance_total[i].x) + 1e-3);
}

TEST(EnvironmentLight, AClosedBoxSeesNothing) {
  scene::Scene scene;
  add_instance(
      &scene, test::box_mesh({0, 0, 0}, {1, 1, 1}, add_material(&scene, {0.8f, 0.8f, 0.8f}), true));
  set_sky(&scene, noise(SphereMapping::Equirectangular, 1));
  const Irradiance e =
      irradiance(scene, {{0.3f, 0, 0.6f}, {1, 0.5f, 0.5f}}, {{0, 1, 0}, {-1, 0, 0}}, 1024);
  for (int64_t i = 0; i < 2; ++i) EXPECT_EQ(e.total(i), (Rgb{0, 0, 0}));
}

/// One bright texel is ∫ L cosθ dω over it: here by a fine quadrature of its own, L cosθ Δω for its
/// middle within the curvature of the cosine.
TEST(EnvironmentLight, OneBrightTexelIsItsSolidAngle) {
  const Vec3 normal = normalize({0.2f, 1, -0.1f});
  for (const SphereMapping mapping : {SphereMapping::Equirectangular, SphereMapping::EqualArea}) {
    const int width = 32, height = mapping == SphereMapping::EqualArea ? 32 : 16;
    for (const auto& [x, y] : {std::pair{5, 2}, {20, 6}, {31, 0}, {0, 9}}) {
      image::Image image(width, height, 3);
      image.set_rgb(x, y, {300, 200, 100});
      for (const bool turned : {false, true}) {
        Environment sky = with_map(image, mapping);
        if (turned) sky.axes = noise(mapping, 1).axes;
        constexpr int kFine = 64;
        double expected = 0, solid_angle = sky.map->solid_angle(y);
        for (int i = 0; i < kFine * kFine; ++i) {
          const Vec2 within{(static_cast<float>(i % kFine) + 0.5f) / kFine,
                            (static_cast<float>(i / kFine) + 0.5f) / kFine};
          const Vec3 direction = sky.to_world(sky.map->direction(x, y, within));
          expected += 300 * solid_angle / (kFine * kFine) * std::max(0.0f, dot(normal, direction));
        }
        scene::Scene scene;  // somewhere else
        add_quad(&scene, {0, -100, 0}, {0, 0, 0.01f}, {0.01f, 0, 0},
                 add_material(&scene, {0, 0, 0}));
        const float middle = dot(normal, sky.to_world(sky.map->direction(x, y, {0.5f, 0.5f})));
        set_sky(&scene, std::move(sky));
        const Irradiance e = irradiance(scene, {{0, 0, 0}}, {normal}, 4096);
        EXPECT_NEAR(e.total(0).x, expected,
                    4.5 * std::sqrt(e.variance_total[0].x) + 2e-3 * expected);
        EXPECT_NEAR(e.total(0).z * 3, e.total(0).x, 1e-4 * e.total(0).x + 1e-6);
        if (middle > 0.3f) {
          EXPECT_NEAR(e.total(0).x, 300 * middle * solid_angle, 0.03 * expected);
        }
      }
    }
  }
}

/// Over a fine equal-area grid: the density integrates to one, and means of samples are integrals.
TEST(EnvironmentSampler, DensityIntegratesToOneAndIsThatOfTheSamples) {
  constexpr int kSide = 1024;
  const Vec3 normal = normalize({1, 2, -1});
  for (const Environment& sky : {noise(SphereMapping::Equirectangular, 2),
                                 noise(SphereMapping::EqualArea, 3), constant({1, 2, 3})}) {
    const EnvironmentSampler sampler(sky);
    ASSERT_FALSE(sampler.black());
    double density = 0, light = 0;
    bool same = true;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec3 direction =
          scene::equal_area_direction((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
      const EnvironmentSample seen = sampler.evaluate(normal, direction);
      same = same && seen.radiance == sky.radiance_from(direction);
      density += seen.pdf;
      light += std::max(0.0f, dot(direction, normal)) * seen.radiance.y;
    }
    EXPECT_TRUE(same);
    const double step = 4 * M_PI / (double{kSide} * kSide);
    EXPECT_NEAR(density * step, 1, 2e-3);
    EXPECT_NEAR(sampler.luminance(), luminance(scene::fluence(sky)), 1e-4 * sampler.luminance());
    Rng rng(4);
    constexpr int kDraws = 200'000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kDraws; ++i) {
      const EnvironmentSample drawn = sampler.sample(normal, {rng.uniform(), rng.uniform()});
      if (!(drawn.pdf > 0)) continue;
      EXPECT_NEAR(length(drawn.direction), 1, 1e-5f);
      const double value =
          std::max(0.0f, dot(drawn.direction, normal)) * drawn.radiance.y / drawn.pdf;
      sum += value;
      squares += value * value;
    }
    const double mean = sum / kDraws;
    const double variance = std::max(0.0, squares / kDraws - mean * mean) / kDraws;
    EXPECT_NEAR(mean, light * step, 4.5 * std::sqrt(variance) + 2e-3 * mean);
  }
  EXPECT_TRUE(EnvironmentSampler(constant({0, 0, 0})).black());
  EXPECT_TRUE(EnvironmentSampler(half_sky(0)).black());
}

/// A furnished room without its ceiling, two lamps in it; and a hall of a hundred, drawn by a tree.
TEST(EnvironmentLight, AgreesWithANaivePathTracerBesideLamps) {
  scene::Scene room = test::furnished_room();
  std::vector<std::array<uint32_t, 3>>& walls = room.meshes[0].triangles;
  walls.erase(walls.begin() + 6, walls.begin() + 8);  // that at y = 2.5
  scene::Scene lamps = room;
  lamps.meshes[3].triangles.clear();
  for (int i = 0; i < 50; ++i)
    test::append_quad(&lamps.meshes[3], {0.5f + 0.05f * static_cast<float>(i), 2.45f, 0.8f},
                      {0.04f, 0, 0}, {0, 0, 0.3f});
  const std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}, {0.9f, 1.1f, 1}};
  const std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  for (scene::Scene* scene : {&room, &lamps}) {
    set_sky(scene, noise(SphereMapping::Equirectangular, 7));
    const Irradiance e = irradiance(*scene, positions, normals, 8192);
    ASSERT_EQ(e.groups, 3);
    const Bvh bvh(*scene);
    constexpr int kPaths = 60'000;
    for (size_t i = 0; i < positions.size(); ++i) {
      const test::NaiveIrradiance naive =
          test::naive_irradiance(bvh, positions[i], normals[i], 5, kPaths, Rng(5, i));
      EXPECT_NEAR(e.total(static_cast<int64_t>(i)).y, naive.mean[1],
                  4 * std::sqrt(naive.variance[1] + e.variance_total[i].y))
          << i;
    }
  }
}

/// Groups add up: the lamps' share is that without a sky, the sky's that without lamps.
TEST(EnvironmentLight, IsALightGroupOfItsOwn) {
  scene::Scene both = test::furnished_room();
  both.meshes[0].triangles.erase(both.meshes[0].triangles.begin() + 6,
                                 both.meshes[0].triangles.begin() + 8);
  scene::Scene dark = both;
  set_sky(&both, constant({1, 1, 1}));
  const std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}};
  const std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}};
  const Irradiance e = irradiance(both, positions, normals, 16384);
  const Irradiance lamps = irradiance(dark, positions, normals, 16384);
  scene::Scene alone = both;
  for (scene::Material& material : alone.materials) material.emission = {0, 0, 0};
  const Irradiance sky = irradiance(alone, positions, normals, 16384);
  for (int64_t i = 0; i < 2; ++i) {
    const auto share = [&](const Irradiance& of, int64_t group) {
      return of.direct[static_cast<size_t>(group * of.points + i)].y +
             of.indirect[static_cast<size_t>(group * of.points + i)].y;
    };
    const auto at = static_cast<size_t>(i);
    const double error = 4.5 * std::sqrt(e.variance_total[at].y + lamps.variance_total[at].y +
                                         sky.variance_total[at].y);
    EXPECT_NEAR(share(e, 0) + share(e, 1), lamps.total(i).y, error);
    EXPECT_NEAR(share(e, 2), sky.total(i).y, error);
  }
}

TEST(EnvironmentLight, DirectAloneIsThatOfWholePaths) {
  scene::Scene scene = plane();
  add_quad(&scene, {1, 0, -2}, {0, 0, 4}, {0, 2, 0}, 0);
  set_sky(&scene, noise(SphereMapping::EqualArea, 5));
  const Bvh bvh(scene);
  const Lights lights(scene);
  IrradianceOptions options;
  options.rays = 512;
  const std::vector<Vec3> positions{{0.5f, 0, 0}}, normals{{0, 1, 0}};
  const Irradiance whole = estimate_irradiance(bvh, lights, positions, normals, options);
  options.direct_only = true;
  const Irradiance direct = estimate_irradiance(bvh, lights, positions, normals, options);
  EXPECT_EQ(direct.direct_sum(0), whole.direct_sum(0));
  EXPECT_GT(whole.indirect_sum(0).x, 0);
  EXPECT_EQ(direct.indirect_sum(0).x, 0);
}

TEST(EnvironmentLight, IsTheBackgroundOfPictures) {
  scene::Scene scene;
  add_quad(&scene, {-0.1f, -0.1f, 0}, {0.2f, 0, 0}, {0, 0.2f, 0}, add_material(&scene, {0, 0, 0}));
  set_sky(&scene, noise(SphereMapping::Equirectangular, 9));
  const Bvh bvh(scene);
  const Lights lights(scene);
  scene::Camera camera;
  camera.origin = {0, 0, 1};
  camera.target = {0, 0, 0};
  const GBuffer hits = trace_gbuffer(bvh, camera, 9, 9);
  const image::Image image = render_reference(bvh, lights, camera, 9, 9, {4096, 3, 1});
  EXPECT_EQ(hits.mask[40], 1);
  EXPECT_EQ(image.rgb(4, 4), (Rgb{0, 0, 0}));
  const Vec3 corner = camera.direction(0.5f / 9, 0.5f / 9, 1);
  EXPECT_EQ(hits.mask[0], 0);
  EXPECT_EQ(hits.emission[0], scene.environment->radiance_from(corner));
  double mean = 0;  // over the pixel
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 d = camera.direction((static_cast<float>(i % 100) + 0.5f) / 900,
                                    (static_cast<float>(i / 100) + 0.5f) / 900, 1);
    mean += scene.environment->radiance_from(d).y / 1e4;
  }
  EXPECT_NEAR(image.rgb(0, 0).y, mean, 0.01 * mean + 1e-4);
}

TEST(EnvironmentLight, RefusesToBeWithoutAGroup) {
  scene::Scene scene = plane();
  scene.environment = constant({1, 1, 1});
  EXPECT_THROW(Lights lights(scene), Error);
}

/// A room with a skylight and a closed cupboard, an outside that the sky reaches, and nothing else
/// that shines.
TEST(Reach, KeepsWhatASkyReachesAndTheEnvironment) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh room = test::box_mesh({0, 0, 0}, {4, 2, 3}, white, true);
  room.triangles.erase(room.triangles.begin() + 6, room.triangles.begin() + 8);
  add_instance(&scene, std::move(room));
  add_instance(&scene, test::box_mesh({1, 0.5f, 1}, {2, 1.5f, 2}, white, true));
  add_instance(&scene, test::box_mesh({1.2f, 0.7f, 1.2f}, {1.8f, 1.3f, 1.8f}, white, true));
  set_sky(&scene, constant({1, 1, 1}));
  const Bvh bvh(scene);
  const std::vector<Vec3> positions{{3, 0, 1}, {1.1f, 0.5f, 1.5f}, {1, 1, 1.5f}};
  EXPECT_EQ(reached(bvh, positions, {{{0, 1, 0}, {0, 1, 0}, {1, 0, 0}}}, Sides::Front, {}),
            (std::vector<uint8_t>{1, 0, 0}));
  PruneCounts counts;
  scene::SamplerOptions sampler;
  const scene::SurfaceSamples samples =
      sample_reached_surface(bvh, 400, sampler, Purpose::Queries, {}, &counts);
  ASSERT_EQ(samples.size(), 400);
  EXPECT_GT(counts.pruned, 0);
  for (size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(samples.light_group[i], i < 380 ? scene::kNone : 0);
    const Vec3& p = samples.position[i];
    const Vec3 from = p - Vec3{1.5f, 1, 1.5f};
    const float away = std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)});
    EXPECT_GT(away, 0.31f) << "the inner box is dark";
    if (away < 0.51f) {
      EXPECT_GT(dot(samples.normal[i], from), 0) << "the outer one shows its back";
    }
  }
}

}  // namespace
}  // namespace lte::pathtrace
