// Environments: mappings against directions known from their definition, and environment points
// against closed forms.
#include "lte/scene/environment.h"

#include <numeric>

#include "lte/base/random.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/scene/environment_points.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/light_points.h"
#include "tests/scene/pbrt/fixture.h"
#include "tests/support/scenes.h"

namespace lte::scene {
namespace {

using test::error_of;
using test::expect_near;
using ::testing::HasSubstr;

image::Image picture(int width, int height, const Rgb& value) {
  image::Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.set_rgb(x, y, value);
  return out;
}

Vec3 random_direction(Rng* rng) {
  const float z = rng->uniform(-1, 1), phi = rng->uniform(0, 2 * kPi);
  const float r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Values by hand from Clarberg's construction: the inner square is the upper hemisphere, along an
/// axis z = 1 - r² with r the distance from the middle, halves of the square.
TEST(EqualAreaMapping, HasTheDirectionsOfPbrt) {
  expect_near(equal_area_direction(0.5, 0.5), {0, 0, 1});
  expect_near(equal_area_direction(1, 0.5), {1, 0, 0});
  expect_near(equal_area_direction(0, 0.5), {-1, 0, 0});
  expect_near(equal_area_direction(0.5, 1), {0, 1, 0});
  expect_near(equal_area_direction(0.5, 0), {0, -1, 0});
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0}) expect_near(equal_area_direction(u, v), {0, 0, -1});
  const float half = std::sqrt(0.5f);
  expect_near(equal_area_direction(0.75, 0.75), {half, half, 0});
  expect_near(equal_area_direction(0.25, 0.75), {-half, half, 0});
  expect_near(equal_area_direction(0.75, 0.5), {std::sqrt(1.75f) / 2, 0, 0.75f});
  expect_near(equal_area_direction(0.5, 0.25), {0, -std::sqrt(1.75f) / 2, 0.75f});
  expect_near(equal_area_direction(0.875, 0.875),
              {std::sqrt(1.75f) / 2 * half, std::sqrt(1.75f) / 2 * half, -0.75f});
}

TEST(EqualAreaMapping, IsInvertedAndKeepsAreas) {
  constexpr int kSide = 6, kDraws = 180'000;
  std::vector<int> counts(kSide * kSide);
  Rng rng(3);
  for (int i = 0; i < kDraws; ++i) {
    const Vec3 direction = random_direction(&rng);
    const Vec2 p = equal_area_point(direction);
    expect_near(equal_area_direction(p.x, p.y), direction, 1e-5f);
    ++counts[static_cast<size_t>(p.y * kSide) * kSide + static_cast<size_t>(p.x * kSide)];
  }
  const double expected = static_cast<double>(kDraws) / (kSide * kSide);
  for (const int count : counts) EXPECT_NEAR(count, expected, 5 * std::sqrt(expected));
}

TEST(EnvironmentMap, EquirectangularPicturesHaveXInTheMiddleAndYOnTop) {
  image::Image image(8, 4, 3);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      image.set_rgb(x, y, {static_cast<float>(x), static_cast<float>(y), 0});
  const EnvironmentMap map(image, SphereMapping::Equirectangular);
  const auto at = [&](const Vec3& d) { return map.radiance(normalize(d)); };
  EXPECT_EQ(at({1, 0.1f, 0.1f}), (Rgb{4, 1, 0})) << "just right of and above the middle";
  EXPECT_EQ(at({1, -0.1f, -0.1f}), (Rgb{3, 2, 0}));
  EXPECT_EQ(at({0.1f, 0.1f, 1}), (Rgb{5, 1, 0})) << "+Z: a quarter of the width further right";
  EXPECT_EQ(at({-0.1f, 0.1f, 1}), (Rgb{6, 1, 0}));
  EXPECT_EQ(at({-0.1f, 0.1f, -1}), (Rgb{1, 1, 0}));
  EXPECT_EQ(at({0.01f, 1, 0.005f}).y, 0) << "+Y on top";
  EXPECT_EQ(at({0.01f, -1, 0.005f}).y, 3);
}

TEST(EnvironmentMap, TexelsShareTheSphereOut) {
  for (const SphereMapping mapping : {SphereMapping::Equirectangular, SphereMapping::EqualArea}) {
    const EnvironmentMap map(picture(12, 12, {1, 1, 1}), mapping);
    double sum = 0;
    for (int y = 0; y < 12; ++y) sum += 12 * map.solid_angle(y);
    EXPECT_NEAR(sum, 4 * M_PI, 1e-12);
    // Directions of a texel lie in it and are spread evenly over it.
    std::vector<double> hits(144);
    Rng rng(5);
    constexpr int kDraws = 144 * 400;
    for (int i = 0; i < kDraws; ++i) ++hits[map.index(random_direction(&rng))];
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        const size_t texel = static_cast<size_t>(y) * 12 + static_cast<size_t>(x);
        const double expected = kDraws * map.solid_angle(y) / (4 * M_PI);
        EXPECT_NEAR(hits[texel], expected, 5 * std::sqrt(expected));
        for (int i = 0; i < 20; ++i) {
          const Vec2 within{0.001f + 0.998f * rng.uniform(), 0.001f + 0.998f * rng.uniform()};
          const Vec3 direction = map.direction(x, y, within);
          EXPECT_NEAR(length(direction), 1, 1e-6f);
          EXPECT_EQ(map.index(direction), texel);
        }
      }
    }
  }
}

TEST(EnvironmentMap, RefusesWhatIsNoRadiance) {
  image::Image bad = picture(4, 2, {1, 1, 1});
  EXPECT_THAT(error_of([&] { EnvironmentMap(bad, SphereMapping::EqualArea); }),
              HasSubstr("square picture, got 4x2"));
  bad.at(3, 1)[2] = NAN;
  EXPECT_THAT(error_of([&] { EnvironmentMap(bad, SphereMapping::Equirectangular); }),
              HasSubstr("texel 3, 1"));
  bad.at(3, 1)[2] = -1;
  EXPECT_THAT(error_of([&] { EnvironmentMap(bad, SphereMapping::Equirectangular); }),
              HasSubstr("not negative"));
}

TEST(SetEnvironment, TakesConstantsAndPictures) {
  const test::TempDir dir;
  Scene scene = test::furnished_room();
  set_environment("0.5,2,1e1", 0, &scene);
  EXPECT_EQ(scene.environment->radiance_from({0, 1, 0}), (Rgb{0.5f, 2, 10}));
  EXPECT_EQ(scene.environment->light_group, 2);
  EXPECT_EQ(scene.light_groups.back(), "environment");

  image::Image image = picture(4, 2, {0, 0, 0});
  image.set_rgb(2, 0, {7, 5, 3});  // right of +X, above the horizon
  image.set_rgb(0, 1, {-1, 0, 0});
  image::write_exr(dir / "sky.exr", {{"", &image}});
  set_environment((dir / "sky.exr").string(), 0, &scene);
  EXPECT_EQ(scene.light_groups.size(), 3u) << "in the place of the first";
  const auto at = [&](const Vec3& d) { return scene.environment->radiance_from(normalize(d)); };
  EXPECT_EQ(at({1, 0.5f, 0.5f}), (Rgb{7, 5, 3}));
  EXPECT_EQ(at({1, 0.5f, -0.5f}), (Rgb{0, 0, 0}));
  EXPECT_EQ(at({-1, -0.5f, -0.5f}), (Rgb{0, 0, 0})) << "negative radiance is none";
  // Counter-clockwise from above: +X goes to -Z.
  set_environment((dir / "sky.exr").string(), 90, &scene);
  EXPECT_EQ(at({0.5f, 0.5f, -1}), (Rgb{7, 5, 3}));
  EXPECT_EQ(at({-0.5f, 0.5f, -1}), (Rgb{0, 0, 0}));

  image = picture(2, 1, {0.5f, 0.5f, 0.5f});
  image::write_png(dir / "grey.png", image);
  set_environment((dir / "grey.png").string(), 0, &scene);
  EXPECT_NEAR(at({1, 0, 0}).x, 0.2140f, 0.002f) << "128 / 255 on the sRGB curve";
}

TEST(SetEnvironment, NamesWhatItCannotUse) {
  const test::TempDir dir;
  Scene scene = test::furnished_room();
  const auto error = [&](const std::string& text, double turn = 0) {
    return error_of([&] { set_environment(text, turn, &scene); });
  };
  EXPECT_THAT(error("1,2"), HasSubstr("environment 1,2: neither three numbers"));
  EXPECT_THAT(error("1,2,3,4"), HasSubstr("neither three numbers"));
  EXPECT_THAT(error("1,2,x"), HasSubstr("neither three numbers"));
  EXPECT_THAT(error("1,-2,3"), HasSubstr("not negative"));
  EXPECT_THAT(error("1,2,inf"), HasSubstr("environment 1,2,inf"));
  EXPECT_THAT(error("1,2,3", NAN), HasSubstr("environment: its turn"));
  EXPECT_THAT(error((dir / "none.exr").string()), HasSubstr("none.exr"));
  write_file(dir / "text.exr", "not a picture");
  EXPECT_THAT(error((dir / "text.exr").string()), HasSubstr("text.exr"));
  EXPECT_FALSE(scene.environment.has_value());
}

/// A unit square with an environment.
Scene open_square() {
  Scene scene;
  scene.name = "square";
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0},
                 test::add_material(&scene, {0.5f, 0.5f, 0.5f}));
  set_environment("2,3,4", 0, &scene);
  return scene;
}

TEST(EnvironmentPoints, GiveTheIrradianceOfAConstantSky) {
  const Scene scene = open_square();
  for (const int64_t count : {1, 2, 3, 7, 100, 1000}) {
    SurfaceSamples samples;
    append_environment_points(scene, count, &samples);
    ASSERT_EQ(samples.size(), count);
    Vec3 sum;
    double area = 0;
    for (size_t i = 0; i < samples.position.size(); ++i) {
      EXPECT_NEAR(length(samples.position[i] - Vec3{0.5f, 0, 0.5f}), std::sqrt(0.5f), 1e-5f);
      EXPECT_NEAR(dot(samples.normal[i], normalize(Vec3{0.5f, 0, 0.5f} - samples.position[i])), 1,
                  1e-5f);
      EXPECT_EQ(samples.emission[i], (Rgb{2, 3, 4}));
      EXPECT_EQ(samples.albedo[i], (Rgb{0, 0, 0}));
      EXPECT_EQ(samples.light_group[i], 0);
      sum += samples.normal[i];
      area += samples.area[i];
    }
    EXPECT_NEAR(area, 4 * M_PI * 0.5, 1e-4);
    if (count < 100) continue;
    EXPECT_LT(length(sum), 0.02f * static_cast<float>(count)) << "from all sides alike";
    // Σ L cosθ area / r² at the centre, for several normals.
    Rng rng(9);
    for (int k = 0; k < 20; ++k) {
      const Vec3 normal = random_direction(&rng);
      double irradiance = 0;
      for (size_t i = 0; i < samples.position.size(); ++i)
        irradiance += samples.emission[i].x * std::max(0.0f, -dot(normal, samples.normal[i])) *
                      samples.area[i] / 0.5f;
      EXPECT_NEAR(irradiance, 2 * M_PI, 0.03 * 2 * M_PI) << count << " points";
    }
  }
}

TEST(EnvironmentPoints, LoseNoLightOfAPicture) {
  Scene scene = open_square();
  image::Image image = picture(64, 32, {0.1f, 0.2f, 0.3f});
  image.set_rgb(37, 6, {5000, 4000, 3000});
  scene.environment->map =
      std::make_shared<const EnvironmentMap>(image, SphereMapping::Equirectangular);
  scene.environment->axes = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  const Rgb all = fluence(*scene.environment);
  const Vec3 sun =
      scene.environment->to_world(scene.environment->map->direction(37, 6, {0.5f, 0.5f}));
  for (const int64_t count : {1, 5, 50, 400, 5000}) {
    SurfaceSamples samples;
    append_environment_points(scene, count, &samples);
    Rgb sum;
    size_t brightest = 0;
    for (size_t i = 0; i < samples.emission.size(); ++i) {
      sum += samples.emission[i] * (4 * kPi / static_cast<float>(count));
      if (samples.emission[i].x > samples.emission[brightest].x) brightest = i;
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], all[c], 1e-3f * all[c]) << count << " points";
    const float least = count >= 5000 ? 0.999f : count >= 50 ? 0.85f : -1.0f;
    EXPECT_GE(dot(sun, -samples.normal[brightest]), least) << count << " points";
  }
}

TEST(EnvironmentPoints, StandLastInTheSamplesOfAScene) {
  const Scene scene = open_square();
  SamplerOptions options;
  options.emissive_share = 0.1;
  const SurfaceSamples samples = sample_surface(scene, 1000, options);
  ASSERT_EQ(samples.size(), 1000);
  double area = 0;
  for (size_t i = 0; i < 950; ++i) {
    EXPECT_EQ(samples.light_group[i], kNone);
    area += samples.area[i];
  }
  EXPECT_NEAR(area, 1, 1e-4) << "of the surface";
  for (size_t i = 950; i < 1000; ++i) EXPECT_EQ(samples.light_group[i], 0);
  options.environment_share = 0;
  const SurfaceSamples plain = sample_surface(scene, 1000, options);
  EXPECT_EQ(std::accumulate(plain.light_group.begin(), plain.light_group.end(), 0), -1000);
  const Bounds bounds = point_bounds(scene);
  for (const Vec3& p : samples.position) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(p[axis], bounds.low[axis] - 1e-5f);
      EXPECT_LE(p[axis], bounds.high[axis] + 1e-5f);
    }
  }
  EXPECT_NEAR(bounds.extent().y, std::sqrt(2.0f), 1e-5f);
}

}  // namespace
}  // namespace lte::scene
