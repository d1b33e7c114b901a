// What the cache says between its records, and where it has nothing to say.
#include "lte/gi/irradiance_cache.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

/// n x n records over [0, 1]² at height z, of the side `normal`; irradiance by `light(x, y)`.
template <typename Light>
void add_grid(int n, float z, const Vec3& normal, const Light& light, CacheRecords* records,
              std::vector<Rgb>* irradiance) {
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(n);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(n);
      records->add({u, v, z}, normal, {0.5f, 0.5f, 0.5f}, 1 / static_cast<float>(n * n));
      irradiance->push_back(light(u, v));
    }
  }
}

scene::Scene sheet() {
  scene::Scene scene;
  add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add_material(&scene, {0.5f, 0.5f, 0.5f}));
  return scene;
}

TEST(IrradianceCache, FollowsALinearFieldBetweenEntries) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  const auto field = [](float x, float y) { return Rgb{1 + x, 2 - y, x + y}; };
  add_grid(20, 0, {0, 0, 1}, field, &records, &light);
  const IrradianceCache cache(bvh, records, light);
  EXPECT_EQ(cache.size(), 400);
  for (const Vec2& p : {Vec2{0.31f, 0.47f}, Vec2{0.5f, 0.5f}, Vec2{0.774f, 0.213f}}) {
    Rgb found;
    ASSERT_TRUE(cache.lookup({p.x, p.y, 0}, {0, 0, 1}, &found));
    const Rgb expected = field(p.x, p.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.01f);
  }
}

TEST(IrradianceCache, KeepsTheSidesOfAWallApart) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  add_grid(
      20, 0, {0, 0, 1},
      [](float, float) {
        return Rgb{1, 1, 1};
      },
      &records, &light);
  add_grid(
      20, 0, {0, 0, -1},
      [](float, float) {
        return Rgb{5, 5, 5};
      },
      &records, &light);
  // Another wall that faces the same way, two centimetres behind.
  add_grid(
      20, -0.02f, {0, 0, 1},
      [](float, float) {
        return Rgb{9, 9, 9};
      },
      &records, &light);
  const IrradianceCache cache(bvh, records, light);
  Rgb found;
  ASSERT_TRUE(cache.lookup({0.4f, 0.6f, 0}, {0, 0, 1}, &found));
  EXPECT_FLOAT_EQ(found.x, 1);
  ASSERT_TRUE(cache.lookup({0.4f, 0.6f, 0}, {0, 0, -1}, &found));
  EXPECT_FLOAT_EQ(found.x, 5);
}

TEST(IrradianceCache, AFloorEndsAtAWallThatStandsOnIt) {
  scene::Scene scene = sheet();
  // At y = 0.5, thin; one side of the floor is bright, the other dark.
  add_quad(&scene, {0, 0.5f, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  const auto step = [](float, float y) { return y < 0.5f ? Rgb{1, 1, 1} : Rgb{0.25f, 0, 0}; };
  add_grid(20, 0, {0, 0, 1}, step, &records, &light);
  const IrradianceCache cache(bvh, records, light);
  for (const float x : {0.2f, 0.333f, 0.5f, 0.81f}) {
    Rgb found;
    ASSERT_TRUE(cache.lookup({x, 0.49f, 0}, {0, 0, 1}, &found));
    EXPECT_FLOAT_EQ(found.x, 1) << x;
    ASSERT_TRUE(cache.lookup({x, 0.51f, 0}, {0, 0, 1}, &found));
    EXPECT_FLOAT_EQ(found.x, 0.25f) << x;
  }
}

TEST(IrradianceCache, SaysWhereItKnowsNothing) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  add_grid(
      10, 0, {0, 0, 1},
      [](float, float) {
        return Rgb{1, 1, 1};
      },
      &records, &light);
  const IrradianceCache cache(bvh, records, light);
  Rgb found;
  EXPECT_FALSE(cache.lookup({0.5f, 0.5f, 0}, {0, 0, -1}, &found));
  EXPECT_FALSE(cache.lookup({0.5f, 0.5f, 0}, {1, 0, 0}, &found));
  EXPECT_FALSE(cache.lookup({0.5f, 0.5f, 0.2f}, {0, 0, 1}, &found));
  EXPECT_FALSE(cache.lookup({1.5f, 0.5f, 0}, {0, 0, 1}, &found));
  EXPECT_FALSE(IrradianceCache(bvh, {}, {}).lookup({0.5f, 0.5f, 0}, {0, 0, 1}, &found));
  EXPECT_THROW(IrradianceCache(bvh, records, std::vector<Rgb>(3)), Error);
  light[7].y = NAN;
  EXPECT_THROW(IrradianceCache(bvh, records, light), Error);
}

TEST(CacheRecords, EstimatesInAClosedBoxAreThoseOfTheFurnaceInsideAndDarkOutside) {
  scene::Scene scene;
  const int wall = add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 200, 1);
  EXPECT_GE(records.size(), 200);
  EXPECT_EQ(records.start.size(), 200u * kRecordPoints);
  EXPECT_EQ(records.first.size(), records.position.size() + 1);
  double area = 0;
  for (const float a : records.area) area += double{a};
  EXPECT_NEAR(area, 2 * 24, 0.1) << "both sides";
  const RecordLight light = estimate_records(bvh, lights, records, 2048, 4, 1);
  const std::vector<Rgb> total = light.total();
  for (size_t i = 0; i < total.size(); ++i) {
    // Inwards is towards the middle.
    const bool inside = dot(records.position[i], records.normal[i]) < 0;
    const double expected = inside ? double{kPi} * test::geometric_sum(0.5, 4) : 0;
    EXPECT_NEAR(double{total[i].x}, expected, 0.1 * expected);
    EXPECT_NEAR(double{light.direct[i].x}, inside ? double{kPi} : 0, inside ? 0.1 : 0);
  }
}

/// A bright patch smaller than a record counts by its area, wherever the records stand.
TEST(CacheRecords, KeepTheLightOfAPatchSmallerThanWhatTheyStandFor) {
  scene::Scene scene = sheet();
  // A spot 8 cm wide on a floor of 1 m² with 25 places: below a screen with a hole.
  const int black = add_material(&scene, {0, 0, 0});
  add_quad(&scene, {-1, -1, 0.1f}, {0, 3, 0}, {1.46f, 0, 0}, black);
  add_quad(&scene, {0.54f, -1, 0.1f}, {0, 3, 0}, {1.46f, 0, 0}, black);
  add_quad(&scene, {0.46f, -1, 0.1f}, {0, 1.46f, 0}, {0.08f, 0, 0}, black);
  add_quad(&scene, {0.46f, 0.54f, 0.1f}, {0, 1.46f, 0}, {0.08f, 0, 0}, black);
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.intensity = {100, 100, 100};
  sun.light_group = 0;
  scene.light_groups.push_back("sun");
  scene.lights.push_back(sun);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  double sum = 0, squares = 0;
  constexpr int kSeeds = 32;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    const CacheRecords records = sample_records(bvh, 50 * 13, seed);  // the screen has area, too
    const RecordLight light = estimate_records(bvh, lights, records, 16, 1, seed);
    double power = 0;
    for (size_t i = 0; i < light.direct.size(); ++i) {
      const bool floor = std::fabs(records.position[i].z) < 0.01f && records.normal[i].z > 0.9f;
      if (floor) power += double{light.direct[i].x} * double{records.area[i]};
    }
    sum += power;
    squares += power * power;
  }
  const double mean = sum / kSeeds;
  EXPECT_NEAR(mean, 100 * 0.08 * 0.08, 0.25 * 100 * 0.08 * 0.08);
  // One point a record would have a deviation of nearly two means.
  EXPECT_LT(std::sqrt(squares / kSeeds - mean * mean), 1.2 * mean);
}

TEST(IrradianceCache, DoesNotKnowTheLightWhereDirectLightIsUneven) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  const auto edge = [](float, float y) { return y < 0.5f ? Rgb{4, 4, 4} : Rgb{0.5f, 0.5f, 0.5f}; };
  add_grid(20, 0, {0, 0, 1}, edge, &records, &light);
  const IrradianceCache cache(bvh, records, light, light);
  Rgb found;
  EXPECT_FALSE(cache.lookup({0.4f, 0.5f, 0}, {0, 0, 1}, &found));
  EXPECT_FALSE(cache.lookup({0.4f, 0.52f, 0}, {0, 0, 1}, &found));
  ASSERT_TRUE(cache.lookup({0.4f, 0.2f, 0}, {0, 0, 1}, &found));
  EXPECT_FLOAT_EQ(found.x, 4);
  ASSERT_TRUE(cache.lookup({0.4f, 0.8f, 0}, {0, 0, 1}, &found));
  EXPECT_FLOAT_EQ(found.x, 0.5f);
  // The same light by way of other surfaces may be noise, and is smoothed.
  const std::vector<Rgb> none(light.size());
  EXPECT_TRUE(
      IrradianceCache(bvh, records, light, none).lookup({0.4f, 0.5f, 0}, {0, 0, 1}, &found));
}

/// Noise of few light samples is no edge of a shadow, which is one in spite of it.
TEST(IrradianceCache, TakesNoiseOfDirectLightForNoDifference) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  const auto misses = [&](float beyond, bool variance_known) {
    CacheRecords records;
    std::vector<Rgb> light;
    const auto edge = [&](float, float y) {
      const float value = y < 0.5f ? 1 : beyond;
      return Rgb{value, value, value};
    };
    add_grid(20, 0, {0, 0, 1}, edge, &records, &light);
    Rng random(1, 1);
    std::vector<float> variance;
    for (Rgb& value : light) {
      variance.push_back(value.x * value.x * 9 / 3);  // of the sum, evenly spread from 0 to 2
      value = value * (2 * random.uniform());
    }
    if (!variance_known) variance.clear();
    const IrradianceCache cache(bvh, records, light, light, variance);
    int missed = 0;
    for (int i = 0; i < 100; ++i) {
      Rgb found;
      const float x = 0.1f + 0.008f * static_cast<float>(i);
      missed += cache.lookup({x, 0.5f, 0}, {0, 0, 1}, &found) ? 0 : 1;
    }
    return missed;
  };
  EXPECT_GT(misses(1, false), 80) << "noise alone";
  EXPECT_LT(misses(1, true), 20);
  EXPECT_GT(misses(0.02f, true), 2 * misses(1, true));
}

/// The witness: the spread of estimates of other seeds. Small lamps, so that light samples alone
/// matter.
TEST(CacheRecords, TellHowWellTheyKnowDirectLight) {
  scene::Scene scene = sheet();
  for (const float x : {0.2f, 0.5f, 0.9f})
    test::add_point_light(&scene, {x, 0.4f, 0.6f}, {1, 0.5f, 0.2f});
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 64, 3);
  constexpr int kSeeds = 64;
  const auto count = static_cast<size_t>(records.size());
  std::vector<double> sum(count), squares(count);
  double told = 0, spread = 0;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    const RecordLight light = estimate_records(bvh, lights, records, 16, 1, seed);
    ASSERT_EQ(light.direct_variance.size(), count);
    for (size_t i = 0; i < count; ++i) {
      const double value =
          double{light.direct[i].x} + double{light.direct[i].y} + double{light.direct[i].z};
      sum[i] += value;
      squares[i] += value * value;
      told += double{light.direct_variance[i]} / kSeeds;
    }
  }
  for (size_t i = 0; i < count; ++i)
    spread += (squares[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
  EXPECT_GT(spread, 0);
  EXPECT_NEAR(told, spread, 0.25 * spread);
  EXPECT_TRUE(estimate_records(bvh, lights, records, 4, 1, 0).direct_variance.empty())
      << "a sample a point";
}

/// A lamp that hangs 5 cm below a ceiling faces down as the ceiling does.
TEST(IrradianceCache, KeepsParallelSheetsApart) {
  scene::Scene scene = sheet();
  add_quad(&scene, {0, 0, 0.05f}, {1, 0, 0}, {0, 1, 0}, 0);
  const pathtrace::Bvh bvh(scene);
  CacheRecords records;
  std::vector<Rgb> light;
  const auto even = [](float value) {
    return [value](float, float) { return Rgb{value, value, value}; };
  };
  for (const float z : {0.0f, 0.05f})
    add_grid(5, z, {0, 0, -1}, even(z > 0 ? 9.0f : 1.0f), &records, &light);
  const IrradianceCache cache(bvh, records, light);
  Rgb found;
  ASSERT_TRUE(cache.lookup({0.45f, 0.55f, 0}, {0, 0, -1}, &found));
  EXPECT_FLOAT_EQ(found.x, 1);
  ASSERT_TRUE(cache.lookup({0.45f, 0.55f, 0.05f}, {0, 0, -1}, &found));
  EXPECT_FLOAT_EQ(found.x, 9);
}

}  // namespace
}  // namespace lte::gi
