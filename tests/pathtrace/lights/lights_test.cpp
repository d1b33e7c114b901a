#include "lte/pathtrace/lights/lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

double draw(Rng& rng) { return rng.next_u32() * 0x1p-32; }

TEST(AliasTable, DrawsInProportionToWeights) {
  const std::vector<double> weights{0.5, 0, 3, 1e-3, 2, 2, 0};
  const AliasTable table(weights);
  constexpr int kDraws = 400'000;
  std::vector<double> counts(weights.size());
  Rng rng(3);
  for (int i = 0; i < kDraws; ++i) {
    float probability = 0;
    const uint32_t index = table.sample(draw(rng), &probability);
    ASSERT_FLOAT_EQ(probability, table.probability(index));
    ++counts[index];
  }
  for (size_t i = 0; i < weights.size(); ++i) {
    const double p = weights[i] / 7.501;
    EXPECT_NEAR(table.probability(static_cast<uint32_t>(i)), p, 1e-7);
    EXPECT_NEAR(counts[i] / kDraws, p, 5 * std::sqrt(p / kDraws)) << "entry " << i;
  }
}

TEST(AliasTable, StaysExactForAMillionEntries) {
  // Every other entry three times as heavy: an alias table with too few random bits would miss the
  // 3 : 1.
  std::vector<double> weights(1'000'000);
  for (size_t i = 0; i < weights.size(); ++i) weights[i] = i % 2 == 0 ? 3 : 1;
  const AliasTable table(weights);
  Rng rng(4);
  int heavy = 0;
  constexpr int kDraws = 400'000;
  for (int i = 0; i < kDraws; ++i) {
    float probability = 0;
    heavy += table.sample(draw(rng), &probability) % 2 == 0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(heavy) / kDraws, 0.75, 0.004);
}

TEST(AliasTable, IsEmptyWithoutWeight) {
  EXPECT_TRUE(AliasTable(std::vector<double>{}).empty());
  EXPECT_TRUE(AliasTable(std::vector<double>{0, 0}).empty());
}

/// Sampling and evaluation agree: what sample() returns as density is what pdf() says of that
/// direction's hit.
TEST(Lights, SampledDensityIsThatOfTheHit) {
  scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  EXPECT_EQ(lights.groups(), 2);
  const Vec3 position{2, 1.2f, 1.5f};
  Rng rng(1);
  int compared = 0;
  for (int i = 0; i < 500; ++i) {
    const LightSample sample =
        lights.sample(position, {}, draw(rng), Vec2{rng.uniform(), rng.uniform()});
    if (!(sample.pdf > 0)) continue;
    const Hit hit = bvh.intersect({position, sample.direction});
    ASSERT_TRUE(hit.valid());
    if (scene.instances[hit.instance].light_group == scene::kNone) continue;  // occluded
    EXPECT_EQ(scene.instances[hit.instance].light_group, sample.light_group);
    EXPECT_NEAR(hit.t, sample.distance, 1e-4f);
    const float pdf = lights.pdf(position, {}, hit.instance, hit.triangle, hit.t * hit.t,
                                 std::fabs(dot(hit.normal, sample.direction)));
    EXPECT_NEAR(pdf, sample.pdf, 1e-3f * sample.pdf);
    ++compared;
  }
  EXPECT_GT(compared, 400);
  EXPECT_EQ(lights.pdf(position, {}, 0, 0, 1, 1), 0) << "a wall is not in the table";
}

/// The mean of radiance · cosine / pdf over samples is the irradiance of the polygon, mirrored and
/// scaled instances too.
TEST(Lights, SamplesIntegrateToTheClosedForm) {
  const Affine transform = test::translation({0.5f, 2, 0.3f}) *
                           test::rotation(normalize({1, 0.3f, 0}), 0.4f) *
                           test::scaling({-1.5f, 0.7f, 1});
  const Vec3 corner{0, 0, 0}, edge1{1, 0, 0},
      edge2{0, 0, 1};  // front: x × z = −y, towards the point
  scene::Scene scene;
  const int material = add_material(&scene, {0, 0, 0}, {2, 2, 2});
  add_instance(&scene, test::quad_mesh(corner, edge1, edge2, material), transform);
  const Lights lights(scene);
  const Vec3 position{0.2f, 0, 0.1f}, normal{0, 1, 0};
  Rng rng(2);
  double sum = 0;
  constexpr int kSamples = 200'000;
  for (int i = 0; i < kSamples; ++i) {
    const LightSample sample =
        lights.sample(position, {}, draw(rng), Vec2{rng.uniform(), rng.uniform()});
    if (sample.pdf > 0) sum += sample.radiance.x * dot(sample.direction, normal) / sample.pdf;
  }
  const std::vector<Vec3> polygon{transform.point(corner), transform.point(corner + edge1),
                                  transform.point(corner + edge1 + edge2),
                                  transform.point(corner + edge2)};
  const double expected = 2 * test::polygon_irradiance(polygon, position, normal);
  EXPECT_NEAR(sum / kSamples, expected, 0.005 * expected);
}

TEST(Lights, EmitFromTheFrontAloneUnlessDoubleSided) {
  for (const bool double_sided : {false, true}) {
    scene::Scene scene;
    const int material = add_material(&scene, {0, 0, 0}, {1, 1, 1}, double_sided);
    add_quad(&scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, material);  // front: −y
    const Lights lights(scene);
    EXPECT_GT(lights.sample({0, 0, 0}, {}, 0.3, {0.4f, 0.6f}).pdf, 0);
    EXPECT_EQ(lights.sample({0, 2, 0}, {}, 0.3, {0.4f, 0.6f}).pdf > 0, double_sided);
    EXPECT_EQ(lights.sample({5, 1, 0}, {}, 0.3, {0.4f, 0.6f}).pdf, 0) << "edge on";
  }
}

TEST(Lights, BlackScenesHaveNone) {
  scene::Scene scene;
  add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add_material(&scene, {1, 1, 1}));
  test::add_point_light(&scene, {0, 0, 1}, {0, 0, 0});
  const Lights lights(scene);
  EXPECT_TRUE(lights.empty());
  EXPECT_EQ(lights.sample({0, 0, 1}, {}, 0.5, {0.5f, 0.5f}).pdf, 0);
}

TEST(Lights, RefuseEmissionWithoutAGroup) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1}, {1, 1, 1});
  add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, material);
  scene.instances[0].light_group = scene::kNone;
  EXPECT_THAT([&] { Lights lights(scene); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("instance 0")));
}

TEST(Lights, PunctualLightsFollowTheExtension) {
  scene::Scene scene;
  test::add_point_light(&scene, {0, 2, 0}, {8, 4, 2});
  scene::PunctualLight& light = scene.lights[0];
  const auto at = [&](const Vec3& p) { return Lights(scene).sample(p, {}, 0.5, {0.5f, 0.5f}); };

  EXPECT_EQ(at({0, 0, 0}).radiance, (Rgb{2, 1, 0.5f})) << "inverse square of 2 m";
  EXPECT_TRUE(at({0, 0, 0}).delta);
  EXPECT_FLOAT_EQ(at({0, 0, 0}).pdf, 1);

  light.range = 4;  // window 1 − (2/4)⁴ = 15/16
  EXPECT_FLOAT_EQ(at({0, 0, 0}).radiance.x, 2 * 15.0f / 16);
  EXPECT_EQ(at({0, -3, 0}).pdf, 0) << "beyond the range";

  light.range = INFINITY;
  light.kind = scene::LightKind::Spot;
  light.direction = {0, -1, 0};
  light.inner_cone = 0.3f;
  light.outer_cone = 0.6f;
  const auto beside = [&](float angle) { return at({2 * std::tan(angle), 0, 0}); };
  const float cosine = std::cos(0.45f);
  const float falloff = (cosine - std::cos(0.6f)) / (std::cos(0.3f) - std::cos(0.6f));
  EXPECT_FLOAT_EQ(at({0, 0, 0}).radiance.x, 2) << "inside the inner cone";
  EXPECT_NEAR(beside(0.45f).radiance.x, 8 * cosine * cosine / 4 * falloff * falloff, 1e-4f);
  EXPECT_EQ(beside(0.61f).pdf, 0) << "outside the outer cone";

  light.kind = scene::LightKind::Directional;
  const LightSample sun = at({7, -3, 1});
  EXPECT_EQ(sun.radiance, (Rgb{8, 4, 2})) << "irradiance at normal incidence anywhere";
  EXPECT_EQ(sun.direction, (Vec3{0, 1, 0}));
  EXPECT_TRUE(std::isinf(sun.distance));
}

}  // namespace
}  // namespace lte::pathtrace
