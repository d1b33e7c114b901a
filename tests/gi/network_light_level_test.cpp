// A guess of light gets its level from the scene: closed forms, and the path tracer's light.
#include "lte/gi/network_light_level.h"

#include <array>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

using test::add_instance;
using test::add_material;

constexpr float kAlbedo = 0.6f;

Rgb mean(const IrradianceCache& cache, std::span<const Vec3> positions,
         std::span<const Vec3> normals) {
  Rgb sum;
  for (size_t i = 0; i < positions.size(); ++i) {
    Rgb here;
    EXPECT_TRUE(cache.lookup(positions[i], normals[i], &here));
    sum += here / static_cast<float>(positions.size());
  }
  return sum;
}

/// A guess that is the same everywhere.
IrradianceSource even(const Rgb& guess) {
  return [guess](std::span<const Vec3> positions, std::span<const Vec3>, std::span<const Rgb>) {
    return std::vector<Rgb>(positions.size(), guess);
  };
}

IrradianceCache leveled(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const CacheRecords& records, const RecordLight& direct,
                        const IrradianceSource& guess, const LevelOptions& options) {
  return level_network_light(bvh, lights, std::make_shared<const CacheGeometry>(bvh, records),
                             records, direct, guess, options);
}

/// In a closed box of radiance 1 and albedo ρ, light of depth 1 to d is π Σ_{k<d} ρ^k.
class EvenlyLitBox : public testing::Test {
 protected:
  EvenlyLitBox() {
    const int wall = add_material(&scene_, {kAlbedo, kAlbedo, kAlbedo}, {1, 1, 1});
    add_instance(&scene_, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  }
  Rgb light(float guess, int max_depth) {
    const pathtrace::Bvh bvh(scene_);
    const pathtrace::Lights lights(scene_);
    const CacheRecords records = sample_records(bvh, 1000, 1);
    const auto count = static_cast<size_t>(records.size());
    LevelOptions options;
    options.max_depth = max_depth;
    RecordLight light;
    light.direct.resize(count);
    for (size_t i = 0; i < count; ++i) {
      const bool inside = dot(records.position[i], records.normal[i]) < 0;
      if (inside) light.direct[i] = {kPi, kPi, kPi};
    }
    return mean(
        leveled(bvh, lights, records, light, even({guess, 2 * guess, 0.5f * guess}), options),
        std::vector<Vec3>{{0, 0, -1}, {0.3f, 1, -0.2f}, {-1, 0.1f, 0.4f}},
        std::vector<Vec3>{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}});
  }
  scene::Scene scene_;
};

TEST_F(EvenlyLitBox, AnyEvenGuessGivesTheSeries) {
  for (const int depth : {3, 5, 8}) {
    const double expected = double{kPi} * test::geometric_sum(double{kAlbedo}, depth - 1);
    for (const float guess : {0.1f, 3.0f, 40.0f}) {
      const Rgb found = light(guess, depth);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(double{found[c]}, expected, 0.01 * expected) << depth << ", guess " << guess;
    }
  }
}

TEST_F(EvenlyLitBox, WithoutAGuessLightIsReflectedTwice) {
  EXPECT_NEAR(light(0, 5).x, kPi * (1 + kAlbedo + kAlbedo * kAlbedo), 0.01f * kPi);
}

TEST_F(EvenlyLitBox, DepthTwoLeavesDirectLightAlone) { EXPECT_NEAR(light(7, 2).x, kPi, 1e-4f); }

TEST(NetworkLightLevel, AGuessOfThreeTimesTheLightIsMended) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 1000, 1);
  const RecordLight truth = estimate_records(bvh, lights, records, 512, 4, 2);
  size_t asked = 0;
  const IrradianceSource guess = [&](std::span<const Vec3> positions, std::span<const Vec3> normals,
                                     std::span<const Rgb>) {
    std::vector<Rgb> out;
    for (size_t k = 0, i = 0; k < positions.size(); ++k, ++i) {
      while (!(records.position[i] == positions[k] && records.normal[i] == normals[k])) ++i;
      out.push_back(truth.indirect[i] * 3);
    }
    asked += out.size();
    return out;
  };
  const IrradianceCache mended = leveled(bvh, lights, records, truth, guess, LevelOptions());
  EXPECT_LT(asked, records.position.size() * 2 / 3) << "insides of things are not asked for";
  const IrradianceCache right(bvh, records, truth.total(), truth.direct);
  double sum = 0, expected = 0;
  int64_t known = 0;
  for (size_t i = 0; i < records.position.size(); ++i) {
    Rgb a, b;
    if (!mended.lookup(records.position[i], records.normal[i], &a) ||
        !right.lookup(records.position[i], records.normal[i], &b))
      continue;
    ++known;
    sum += double{a.y} * double{records.area[i]};
    expected += double{b.y} * double{records.area[i]};
  }
  EXPECT_GT(known, records.size() / 3);
  EXPECT_NEAR(sum, expected, 0.15 * expected);
}

/// Modellers wind walls either way: the side of a record that light reaches may be any of the two.
TEST(NetworkLightLevel, WallsMayBeWoundEitherWay) {
  std::array<Rgb, 2> found;
  for (const bool outwards : {false, true}) {
    scene::Scene scene = test::furnished_room();
    for (scene::Mesh& mesh : scene.meshes) {
      if (!outwards || scene.materials[static_cast<size_t>(mesh.material)].emissive()) continue;
      for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    }
    const pathtrace::Bvh bvh(scene);
    const pathtrace::Lights lights(scene);
    const CacheRecords records = sample_records(bvh, 1000, 1);
    const RecordLight direct = estimate_records(bvh, lights, records, 256, 1, 2);
    LevelOptions options;
    options.rays = 64;
    found[outwards] = mean(leveled(bvh, lights, records, direct, even({3, 3, 3}), options),
                           std::vector<Vec3>{{2, 0, 0.6f}, {0, 1.5f, 2}, {4, 1, 1}},
                           std::vector<Vec3>{{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}});
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[1][c], found[0][c], 0.05f * found[0][c]);
}

/// Of two bounces nothing is left of the guess, and no light of more comes by rays that go on.
TEST(NetworkLightLevel, OfFewBouncesLightIsTraced) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 2000, 1);
  for (const int depth : {3, 4}) {
    const RecordLight truth = estimate_records(bvh, lights, records, 1024, depth - 1, 2);
    LevelOptions options;
    options.max_depth = depth;
    options.rays = 16;
    const IrradianceCache found = leveled(bvh, lights, records, truth, even({9, 9, 9}), options);
    const IrradianceCache right(bvh, records, truth.total(), truth.direct);
    double sum = 0, expected = 0;
    for (size_t i = 0; i < records.position.size(); ++i) {
      Rgb a, b;
      if (!found.lookup(records.position[i], records.normal[i], &a) ||
          !right.lookup(records.position[i], records.normal[i], &b))
        continue;
      sum += double{a.y} * double{records.area[i]};
      expected += double{b.y} * double{records.area[i]};
    }
    EXPECT_NEAR(sum, expected, 0.03 * expected) << "depth " << depth;
  }
}

TEST(NetworkLightLevel, AnotherNumberOfValuesIsRefused) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const CacheRecords records = sample_records(bvh, 100, 1);
  const RecordLight direct = estimate_records(bvh, lights, records, 4, 1, 2);
  const auto three = [](auto...) { return std::vector<Rgb>(3); };
  EXPECT_THROW(leveled(bvh, lights, records, direct, three, LevelOptions()), Error);
}

}  // namespace
}  // namespace lte::gi
