// The light tree: a true distribution, zero only where nothing arrives, and the same irradiance as
// drawing lights by power, with less noise.
#include "lte/pathtrace/lights/light_tree.h"

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

float safe_sqrt(float x) { return std::sqrt(std::max(0.0f, x)); }
float sine(float cosine) { return safe_sqrt(1 - cosine * cosine); }

Vec3 random_unit(Rng& rng) {
  const float z = rng.uniform(-1, 1), phi = 2 * kPi * rng.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}
Vec3 random_point(Rng& rng, float extent) {
  return {rng.uniform(0, extent), rng.uniform(0, extent), rng.uniform(0, extent)};
}

/// Small flat lights, every fifth two-sided and every seventh black, and a few that shine all
/// around.
std::vector<LightCluster> random_lights(Rng& rng, size_t count) {
  std::vector<LightCluster> lights(count);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 p = random_point(rng, 10);
    lights[i].bounds.extend(p);
    lights[i].bounds.extend(p + random_point(rng, 0.3f));
    lights[i].axis = random_unit(rng);
    lights[i].power = i % 7 == 0 ? 0 : std::exp(rng.uniform(-4, 4));
    lights[i].cos_e = 0;
    lights[i].two_sided = i % 5 == 0;
    if (i % 11 == 0) lights[i].cos_o = -1;
  }
  return lights;
}

TEST(LightTree, ProbabilitiesAreADistributionAndThoseOfItsDraws) {
  Rng rng(4);
  const std::vector<LightCluster> lights = random_lights(rng, 60);
  const LightTree tree(lights);
  for (int trial = 0; trial < 4; ++trial) {
    const Vec3 position = random_point(rng, 10);
    const Vec3 normal = trial == 0 ? Vec3{} : random_unit(rng);
    double sum = 0;
    for (uint32_t i = 0; i < lights.size(); ++i) sum += tree.probability(position, normal, i);
    constexpr int kDraws = 20'000;
    std::vector<int> drawn(lights.size());
    int none = 0;
    for (int k = 0; k < kDraws; ++k) {
      uint32_t light = 0;
      float probability = 0;
      if (!tree.sample(position, normal, (k + 0.5) / kDraws, &light, &probability)) {
        ++none;
        continue;
      }
      ASSERT_NEAR(probability, tree.probability(position, normal, light), 1e-5 * probability);
      ++drawn[light];
    }
    // What is not a light is a branch without any that can shine here.
    EXPECT_NEAR(sum + none / double{kDraws}, 1, 5e-3);
    for (uint32_t i = 0; i < lights.size(); ++i)  // u is a regular grid, cut into few intervals
      EXPECT_NEAR(drawn[i] / double{kDraws}, tree.probability(position, normal, i), 2e-3) << i;
  }
}

/// cos(max(0, a − b)) and sin(max(0, a − b)) of angles in [0, π].
float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
float sin_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 0 : sin_a * cos_b - cos_a * sin_b;
}

/// An upper estimate, up to a factor, of what a cluster brings to a point, by scalars.
float cluster_importance(const LightCluster& cluster, const Vec3& position, const Vec3& normal) {
  const Vec3 offset = position - cluster.bounds.center();
  const Vec3 half = cluster.bounds.extent() * 0.5f;
  const float radius2 = dot(half, half), distance2 = dot(offset, offset);
  const float d2 = std::max(distance2, radius2);
  if (!(d2 > 0)) return cluster.power;  // on a light without extent
  const Vec3 from_light = distance2 > 0 ? offset * (1 / std::sqrt(distance2)) : Vec3{0, 0, 1};
  // The cone that the bounding sphere is seen under; all directions from inside.
  const float cos_b = distance2 <= radius2 * 1.0001f ? -1 : safe_sqrt(1 - radius2 / distance2);
  const float sin_b = sine(cos_b);
  float cos_w = std::clamp(dot(cluster.axis, from_light), -1.0f, 1.0f);
  if (cluster.two_sided) cos_w = std::fabs(cos_w);
  const float sin_w = sine(cos_w), sin_o = sine(cluster.cos_o);
  const float cos_x = cos_difference(sin_w, cos_w, sin_o, cluster.cos_o);
  const float sin_x = sin_difference(sin_w, cos_w, sin_o, cluster.cos_o);
  const float cos_emitted = cos_difference(sin_x, cos_x, sin_b, cos_b);
  if (cos_emitted <= cluster.cos_e) return 0;
  // Spots shine less than half around, but all that they do counts: no cosine law for them.
  float importance = cluster.power * std::max(cos_emitted, 0.0f) / d2;
  if (dot(normal, normal) > 0) {
    const float cos_i = std::clamp(-dot(from_light, normal), -1.0f, 1.0f);
    importance *= std::max(0.0f, cos_difference(sine(cos_i), cos_i, sin_b, cos_b));
  }
  return importance;
}

/// The tree works out both children of a node at once.
TEST(LightTree, SharesDrawsByTheImportanceOfEachLight) {
  Rng rng(12);
  int of_both = 0, of_one = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<LightCluster> lights = random_lights(rng, 23);
    lights = {lights[1 + static_cast<size_t>(trial) % 20],
              lights[2 + static_cast<size_t>(trial) % 20]};
    Vec3 position = random_point(rng, 10);
    if (trial % 10 == 3) position = lights[0].bounds.center();
    if (trial % 10 == 5) lights[1].bounds.high = lights[1].bounds.low;
    const Vec3 normal = trial % 4 == 0 ? Vec3{} : random_unit(rng);
    const double a = cluster_importance(lights[0], position, normal);
    const double b = cluster_importance(lights[1], position, normal);
    const double share = LightTree(lights).probability(position, normal, 0);
    if (!(lights[0].power > 0 && lights[1].power > 0)) continue;
    if (!(a + b > 0)) {
      EXPECT_EQ(share, 0);
      continue;
    }
    (a > 0 && b > 0 ? of_both : of_one) += 1;
    EXPECT_NEAR(share, a / (a + b), 1e-6);
  }
  EXPECT_GT(of_both, 200);
  EXPECT_GT(of_one, 200);
}

/// More nodes than a walk has room for, so that some push others out.
TEST(LightTree, AWalkDrawsWhatTheTreeDraws) {
  Rng rng(8);
  const LightTree few(random_lights(rng, 40)), many(random_lights(rng, 3000));
  LightTreeWalk walk;
  for (int trial = 0; trial < 20; ++trial) {
    const LightTree& tree = trial % 2 == 0 ? few : many;
    const Vec3 position = random_point(rng, 10), normal = random_unit(rng);
    walk.start(tree, position, normal);
    for (int k = 0; k < 300; ++k) {
      const double u = rng.uniform();
      uint32_t light = 0, again = 0;
      float probability = 0, same = 0;
      const bool drawn = tree.sample(position, normal, u, &light, &probability);
      ASSERT_EQ(walk.sample(u, &again, &same), drawn);
      ASSERT_EQ(again, light);
      ASSERT_EQ(same, probability);
    }
  }
}

TEST(LightTree, LeavesOutOnlyWhatCannotShineHere) {
  Rng rng(9);
  const std::vector<LightCluster> lights = random_lights(rng, 200);
  const LightTree tree(lights);
  int zeros = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 position = random_point(rng, 10), normal = random_unit(rng);
    for (uint32_t i = 0; i < lights.size(); ++i) {
      if (tree.probability(position, normal, i) > 0) continue;
      ++zeros;
      if (lights[i].power == 0) continue;
      // No place of the light may both see the point in front of it and be above its horizon.
      for (int corner = 0; corner < 27; ++corner) {
        const Vec3 t{static_cast<float>(corner % 3) / 2, static_cast<float>(corner / 3 % 3) / 2,
                     static_cast<float>(corner / 9) / 2};
        const Vec3 place = lights[i].bounds.low + lights[i].bounds.extent() * t;
        const Vec3 towards = normalize(place - position);
        float front = -dot(lights[i].axis, towards);
        if (lights[i].two_sided) front = std::fabs(front);
        if (lights[i].cos_o < 0) front = 1;
        EXPECT_FALSE(front > 1e-4f && dot(normal, towards) > 1e-4f) << "light " << i;
      }
    }
  }
  EXPECT_GT(zeros, 100);
}

TEST(LightTree, EmptyAndSingle) {
  uint32_t light = 7;
  float probability = 0;
  EXPECT_FALSE(LightTree(std::vector<LightCluster>{}).sample({}, {}, 0.5, &light, &probability));
  LightCluster only;
  only.bounds.extend({0, 0, 0});
  only.power = 2;
  only.cos_o = -1;
  only.cos_e = 0;
  const LightTree tree({LightCluster{}, only});
  ASSERT_TRUE(tree.sample({1, 2, 3}, {}, 0.9, &light, &probability));
  EXPECT_EQ(light, 1u);
  EXPECT_EQ(probability, 1);
  EXPECT_EQ(tree.probability({1, 2, 3}, {}, 0), 0) << "black";
}

TEST(LightTree, CoincidentLightsStayApart) {
  std::vector<LightCluster> lights(100);
  for (LightCluster& light : lights) {
    light.bounds.extend({1, 1, 1});
    light.power = 1;
    light.cos_e = 0;
  }
  const LightTree tree(lights);
  for (uint32_t i = 0; i < lights.size(); ++i)
    EXPECT_NEAR(tree.probability({1, 1, 3}, {}, i), 0.01, 1e-5);
}

TEST(LightTree, GivesTheIrradianceOfDrawingByPowerWithLessNoise) {
  const scene::Scene scene = test::hall_of_lamps();
  const Bvh bvh(scene);
  const Lights tree(scene, LightChoice::Tree), power(scene, LightChoice::Power);
  const std::vector<Vec3> positions{{3, 0, 3}, {10, 0, 10}, {12, 0, 4}, {0, 1, 7}, {15, 3, 15.5f}};
  const std::vector<Vec3> normals{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, -1, 0}};
  IrradianceOptions options;
  options.rays = 1 << 14;
  options.max_depth = 3;
  const Irradiance a = estimate_irradiance(bvh, tree, positions, normals, options);
  options.seed = 2;
  const Irradiance b = estimate_irradiance(bvh, power, positions, normals, options);
  double noise_a = 0, noise_b = 0;
  for (int64_t i = 0; i < a.points; ++i) {
    const auto at = static_cast<size_t>(i);
    for (int c = 0; c < 3; ++c) {
      const double error = std::sqrt(a.variance_total[at][c] + b.variance_total[at][c]);
      EXPECT_NEAR(a.total(i)[c], b.total(i)[c], 4 * error) << i << ' ' << c;
    }
    noise_a += a.variance_total[at].x;
    noise_b += b.variance_total[at].x;
  }
  EXPECT_LT(noise_a, noise_b / 2);
}

TEST(LightTree, DirectionalLightsAreDrawnBesideIt) {
  scene::Scene scene = test::hall_of_lamps();
  test::add_point_light(&scene, {0, 0, 0}, {5, 5, 5});
  scene.lights[2].kind = scene::LightKind::Directional;
  scene.lights[2].direction = {0, -1, 0};
  const Lights lights(scene, LightChoice::Tree);
  Rng rng(1);
  double irradiance = 0;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const LightSample s = lights.sample({10, 0, 10}, {0, 1, 0}, rng.next_u32() * 0x1p-32,
                                        {rng.uniform(), rng.uniform()});
    if (s.pdf > 0 && std::isinf(s.distance)) irradiance += s.radiance.x / s.pdf / kDraws;
  }
  EXPECT_NEAR(irradiance, 5, 0.4);
}

}  // namespace
}  // namespace lte::pathtrace
