// Rays aimed at bright places: their density against its integral, and a gather against the closed
// form of one bright square.
#include "lte/gi/bright_places.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/gi/gather.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

/// A dark floor and one square of 0.2 m, 2 m above it, whose front looks down.
class BrightSquare : public testing::Test {
 protected:
  static constexpr float kEdge = 0.2f, kHeight = 2, kAlbedo = 0.5f, kLight = 300;

  BrightSquare() {
    const int dark = test::add_material(&scene_, {0.01f, 0.01f, 0.01f});
    const int square = test::add_material(&scene_, {kAlbedo, kAlbedo, kAlbedo});
    test::add_quad(&scene_, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, dark);
    test::add_quad(&scene_, {-kEdge / 2, kHeight, -kEdge / 2}, {kEdge, 0, 0}, {0, 0, kEdge},
                   square);
    test::add_quad(&scene_, {3, 0.1f, 3}, {0.01f, 0, 0}, {0, 0, 0.01f},
                   test::add_material(&scene_, {}, {1e-6f, 0, 0}));  // no light: no rays
    for (int x = -20; x < 20; ++x) {
      for (int z = -20; z < 20; ++z) {
        records_.add({0.2f * static_cast<float>(x) + 0.1f, 0, 0.2f * static_cast<float>(z) + 0.1f},
                     {0, 1, 0}, {0.01f, 0.01f, 0.01f}, 0.04f);
        light_.push_back({1, 1, 1});
      }
    }
    records_.add({0, kHeight, 0}, {0, -1, 0}, {kAlbedo, kAlbedo, kAlbedo}, kEdge * kEdge);
    light_.push_back({kLight, kLight, kLight});
  }

  scene::Scene scene_;
  CacheRecords records_;
  std::vector<Rgb> light_;
};

TEST_F(BrightSquare, DensityIntegratesToOneAndIsThatOfTheSamples) {
  const BrightPlaces places(records_, light_);
  for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{1, 0, 0.5f}, Vec3{0.1f, 1.8f, 0}}) {
    const Vec3 normal{0, 1, 0};
    const Aim aim = places.aim(position, normal);
    ASSERT_GT(aim.share(), 0.05f);
    Rng rng(3, 7);
    constexpr int kSamples = 2000000;
    double density = 0, slope = 0, sampled = 0;
    const auto rises = [](const Vec3& w) { return double{w.y} * double{w.y} + double{w.x}; };
    for (int k = 0; k < kSamples; ++k) {
      const float y = 2 * rng.uniform() - 1, phi = 2 * kPi * rng.uniform();
      const float r = std::sqrt(std::max(0.0f, 1 - y * y));
      const Vec3 uniform{r * std::cos(phi), y, r * std::sin(phi)};
      const double pdf = double{aim.pdf(std::max(y, 0.0f), uniform)} * 4 * double{kPi};
      density += pdf;
      slope += pdf * rises(uniform);
      sampled += rises(aim.sample(normal, {rng.uniform(), rng.uniform()}));
    }
    EXPECT_NEAR(density / kSamples, 1, 0.02);
    EXPECT_NEAR(sampled / kSamples, slope / kSamples, 0.02);
  }
}

/// By the cosine, one ray in 500 would meet the square: 64 rays would be off by three times the
/// light.
TEST_F(BrightSquare, FewRaysFindTheLightOfItsFormFactor) {
  const pathtrace::Bvh bvh(scene_);
  const pathtrace::Lights lights(scene_);
  const IrradianceCache cache(bvh, records_, light_);
  const std::vector<Vec3> positions{{0, 0, 0}, {0.5f, 0, 0}, {1, 0, 1}};
  const std::vector<Vec3> normals(3, {0, 1, 0});
  GatherOptions options;
  options.rays = 64;
  options.near = 0;
  const Gathered gathered = gather_irradiance(bvh, lights, cache, positions, normals, options);
  for (size_t i = 0; i < positions.size(); ++i) {
    const double d2 = double{dot(positions[i], positions[i])} + double{kHeight * kHeight};
    const double cosine = double{kHeight} / std::sqrt(d2);
    // A square this small is a point: its form factor is right to 0.5 %.
    const double expected =
        double{kAlbedo * kLight} / double{kPi} * double{kEdge * kEdge} * cosine * cosine / d2;
    EXPECT_NEAR(double{gathered.indirect[i].x}, expected, 0.15 * expected) << i;
  }
}

TEST(BrightPlaces, NoneWhereLightIsEven) {
  CacheRecords records;
  std::vector<Rgb> light;
  for (int i = 0; i < 100; ++i) {
    records.add({static_cast<float>(i), 0, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.5f}, 1);
    const float e = 1 + 0.5f * static_cast<float>(i % 3);
    light.push_back({e, e, e});
  }
  EXPECT_TRUE(BrightPlaces(records, light).empty());
  EXPECT_TRUE(BrightPlaces(records, std::vector<Rgb>(100)).empty());
  EXPECT_TRUE(BrightPlaces(CacheRecords(), {}).empty());
}

}  // namespace
}  // namespace lte::gi
