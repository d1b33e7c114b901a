// Irradiance against closed forms and against a naive path tracer that shares no code.
#include "lte/pathtrace/irradiance.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/scene/surface.h"
#include "tests/support/closed_forms.h"
#include "tests/support/naive_path_tracer.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;
using test::geometric_sum;

IrradianceOptions with(int rays, int max_depth = 5, uint64_t seed = 1) {
  IrradianceOptions options;
  options.rays = rays;
  options.max_depth = max_depth;
  options.seed = seed;
  return options;
}

Irradiance at(const scene::Scene& scene, const std::vector<Vec3>& positions,
              const std::vector<Vec3>& normals, const IrradianceOptions& options) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  return estimate_irradiance(bvh, lights, positions, normals, options);
}

/// Four standard errors as the estimate itself states them, and a floor for rounding.
double tolerance(const Irradiance& e, int64_t point, double expected) {
  return 4.5 * std::sqrt(e.variance_total[point].x) + 2e-4 * expected;
}

/// Leaves the largest and the mean relative error of a test in its report (--gtest_output=json),
/// from where docs/validation.md quotes them.
class ErrorRecord {
 public:
  ErrorRecord() = default;
  ErrorRecord(const ErrorRecord&) = delete;
  ErrorRecord& operator=(const ErrorRecord&) = delete;
  ~ErrorRecord() {
    testing::Test::RecordProperty("worst_percent", concat(100 * worst_));
    testing::Test::RecordProperty("mean_percent", concat(100 * sum_ / count_));
  }
  void add(double value, double expected) {
    const double error = value / expected - 1;
    worst_ = std::max(worst_, std::fabs(error));
    sum_ += error;
    ++count_;
  }

 private:
  double worst_ = 0, sum_ = 0;
  int count_ = 0;
};

/// Points on the inner faces of a box [-1, 1]³, near edges and corners too.
void box_points(std::vector<Vec3>* positions, std::vector<Vec3>* normals) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      for (const Vec2& uv : {Vec2{0.1f, -0.3f}, Vec2{0.999f, 0.2f}, Vec2{-0.995f, 0.998f}}) {
        Vec3 p, n;
        p[axis] = side;
        p[(axis + 1) % 3] = uv.x;
        p[(axis + 2) % 3] = uv.y;
        n[axis] = -side;
        positions->push_back(p);
        normals->push_back(n);
      }
    }
  }
}

/// In a closed box whose walls all have radiance L and albedo ρ, E = π L Σ_{k<d} ρ^k everywhere.
void expect_furnace(const Affine& transform, float radiance) {
  ErrorRecord record;
  constexpr float kAlbedo = 0.6f;
  std::vector<Vec3> positions, normals;
  box_points(&positions, &normals);
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3 tip = transform.point(positions[i] + normals[i]);
    positions[i] = transform.point(positions[i]);
    normals[i] = normalize(tip - positions[i]);
  }
  scene::Scene scene;
  const int material =
      add_material(&scene, {kAlbedo, kAlbedo, kAlbedo}, {radiance, radiance, radiance});
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, material, true), transform);
  for (const int depth : {1, 2, 5}) {
    const Irradiance e = at(scene, positions, normals, with(2048, depth));
    const double direct = kPi * radiance;
    const double total = direct * geometric_sum(kAlbedo, depth);
    for (int64_t i = 0; i < e.points; ++i) {
      EXPECT_NEAR(e.total(i).x, total, tolerance(e, i, total))
          << "point " << i << " depth " << depth;
      record.add(e.total(i).x, total);
      EXPECT_NEAR(e.direct_sum(i).x, direct, 0.1 * direct);
      EXPECT_LT(std::sqrt(e.variance_total[i].x), 0.03 * total);
    }
  }
}

TEST(Furnace, ClosedBox) { expect_furnace({}, 1.5f); }

TEST(Furnace, RotatedMirroredScaledInstance) {
  expect_furnace(test::translation({5, -3, 2}) * test::rotation(normalize({1, 2, 3}), 1.1f) *
                     test::scaling({-3, 3, 3}),
                 1);
}

TEST(Furnace, AMillionMetresAway) {
  expect_furnace(test::translation({1e6f, -1e6f, 1e6f}) * test::scaling({50, 50, 50}), 1);
}

TEST(Furnace, AMicrometreLargeAndAThousandKilometresLarge) {
  expect_furnace(test::scaling({1e-6f, 1e-6f, 1e-6f}), 1);
  expect_furnace(test::scaling({1e6f, 1e6f, 1e6f}), 1);
}

TEST(Furnace, RadianceFromAMillionthToAMillion) {
  expect_furnace({}, 1e-6f);
  expect_furnace({}, 1e6f);
}

/// A point light in the centre of a sphere: every bounce is uniform, E = I / R² Σ_{k<d} ρ^k.
TEST(IntegratingSphere, PointLightInTheCentre) {
  constexpr float kRadius = 2, kAlbedo = 0.7f, kIntensity = 3;
  scene::Scene scene;
  const int material = add_material(&scene, {kAlbedo, kAlbedo, kAlbedo});
  add_instance(&scene, test::inward_sphere_mesh(kRadius, 5, material));
  test::add_point_light(&scene, {0, 0, 0}, {kIntensity, kIntensity, kIntensity});
  std::vector<Vec3> positions, normals;
  for (const Vec3& direction : {Vec3{0.3f, 0.5f, 0.2f}, Vec3{-0.7f, 0.1f, 0.9f}}) {
    normals.push_back(-normalize(direction));
    positions.push_back(normals.back() * -0.99f * kRadius);
  }
  const double direct = kIntensity / std::pow(0.99 * kRadius, 2);
  const double bounced = kIntensity / (kRadius * kRadius);  // incident on the wall
  ErrorRecord record;
  for (const int depth : {1, 2, 6}) {
    const Irradiance e = at(scene, positions, normals, with(1 << 14, depth));
    for (int64_t i = 0; i < e.points; ++i) {
      EXPECT_NEAR(e.direct_sum(i).x, direct, 1e-5 * direct);
      const double indirect = bounced * kAlbedo * geometric_sum(kAlbedo, depth - 1) * (depth > 1);
      EXPECT_NEAR(e.indirect_sum(i).x, indirect, 0.004 * bounced + tolerance(e, i, 0));
      record.add(e.total(i).x, direct + indirect);
    }
  }
}

TEST(RectangleLight, MatchesLambertsClosedForm) {
  const Vec3 corner{-0.5f, 2, -0.75f}, edge1{1, 0, 0}, edge2{0, 0, 1.5f};
  scene::Scene scene;
  const int light = add_material(&scene, {0, 0, 0}, {4, 2, 1});
  add_quad(&scene, corner, edge1, edge2, light);
  const std::vector<Vec3> polygon{corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
  const std::vector<Vec3> positions{{0, 0, 0},           {3, 0, 1},    {0.2f, 1.9f, 0.1f},
                                    {0, 1, 0},           {2, 1.8f, 0}, {0.4f, 1.2f, 0.3f},
                                    {-0.5f, 1.99f, 0.2f}};
  const std::vector<Vec3> normals{{0, 1, 0},
                                  {0, 1, 0},
                                  {0, 1, 0},
                                  {1, 0, 0},  // the light straddles the horizon
                                  {-1, 0, 0},
                                  normalize({1, 0.4f, -1}),
                                  normalize({0.3f, 1, 0})};
  ErrorRecord record;
  for (const bool direct_only : {false, true}) {
    IrradianceOptions options = with(1 << 15);
    options.direct_only = direct_only;
    const Irradiance e = at(scene, positions, normals, options);
    for (int64_t i = 0; i < e.points; ++i) {
      const double unit = test::polygon_irradiance(polygon, positions[i], normals[i]);
      ASSERT_GT(unit, 0);
      record.add(e.total(i).x, 4 * unit);
      EXPECT_NEAR(e.total(i).x, 4 * unit, tolerance(e, i, 4 * unit)) << "point " << i;
      EXPECT_NEAR(e.total(i).x, 4 * unit, 0.01 * 4 * unit) << "point " << i;
      EXPECT_FLOAT_EQ(e.total(i).y, e.total(i).x / 2);
      EXPECT_FLOAT_EQ(e.total(i).z, e.total(i).x / 4);
      EXPECT_EQ(e.indirect_sum(i), (Rgb{0, 0, 0})) << "nothing reflects";
    }
  }
}

TEST(RectangleLight, BehindTheSurfaceOrSeenFromBehindGivesNothing) {
  scene::Scene scene;
  add_quad(&scene, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, add_material(&scene, {0, 0, 0}, {1, 1, 1}));
  const Irradiance e = at(scene, {{0, 0, 0}, {0, 3, 0}}, {{0, -1, 0}, {0, -1, 0}}, with(64));
  EXPECT_EQ(e.total(0), (Rgb{0, 0, 0}));
  EXPECT_EQ(e.total(1), (Rgb{0, 0, 0}));
}

/// A patch so small that E = L A cosθ cosθ' / r².
TEST(RectangleLight, SmallPatchIsAPointSource) {
  scene::Scene scene;
  constexpr float kEdge = 1e-3f, kRadiance = 1e6f;
  add_quad(&scene, {0, 3, 0}, {kEdge, 0, 0}, {0, 0, kEdge},
           add_material(&scene, {0, 0, 0}, {kRadiance, kRadiance, kRadiance}));
  const Irradiance e = at(scene, {{4, 0, 0}}, {{0, 1, 0}}, with(1024));
  const double expected = kRadiance * kEdge * kEdge * 0.6 * 0.6 / 25;
  EXPECT_NEAR(e.total(0).x, expected, 2e-3 * expected);
  ErrorRecord().add(e.total(0).x, expected);
}

TEST(RectangleLight, OccludersCastTheirShadow) {
  const Vec3 corner{-1, 2, -1};
  scene::Scene scene;
  const int black = add_material(&scene, {0, 0, 0});
  add_quad(&scene, corner, {2, 0, 0}, {0, 0, 2}, add_material(&scene, {0, 0, 0}, {1, 1, 1}));
  // Just under the light; its edge is right above the point, which sees the half with x > 0.
  add_quad(&scene, {-1.5f, 1.999f, -1.5f}, {1.5f, 0, 0}, {0, 0, 3}, black);
  const std::vector<Vec3> visible{{0, 2, -1}, {1, 2, -1}, {1, 2, 1}, {0, 2, 1}};
  const Irradiance e = at(scene, {{0, 0, 0}}, {{0, 1, 0}}, with(1 << 15));
  const double expected = test::polygon_irradiance(visible, {0, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(e.total(0).x, expected, tolerance(e, 0, expected) + 1e-3 * expected);
  ErrorRecord().add(e.total(0).x, expected);
}

TEST(TexturedLight, IlluminatesByItsTexels) {
  constexpr int kWidth = 256;
  std::vector<uint8_t> texels(kWidth * 3);
  for (int x = kWidth / 2; x < kWidth; ++x) texels[3 * x] = 255;  // the far half is red
  scene::Scene scene;
  const int material = add_material(&scene, {0, 0, 0}, {5, 5, 5});
  scene.textures.push_back(std::make_shared<scene::Texture>(kWidth, 1, texels, true));
  scene::TextureRef& ref = scene.materials[material].emission_texture;
  ref.texture = 0;
  ref.wrap_u = ref.wrap_v = scene::Wrap::ClampToEdge;
  add_quad(&scene, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, material);
  const Vec3 position{0.3f, 0, 0}, normal{0, 1, 0};
  const Irradiance e = at(scene, {position}, {normal}, with(8192));
  const double expected = 5 * test::polygon_irradiance(
                                  {{0, 2, -1}, {1, 2, -1}, {1, 2, 1}, {0, 2, 1}}, position, normal);
  EXPECT_NEAR(e.total(0).x, expected, tolerance(e, 0, expected) + 0.005 * expected);
  ErrorRecord().add(e.total(0).x, expected);
  EXPECT_EQ(e.total(0).y, 0);
}

TEST(PunctualLights, DirectIrradianceIsExactAndShadowed) {
  scene::Scene scene;
  const int black = add_material(&scene, {0, 0, 0});
  add_quad(&scene, {-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, black);
  add_quad(&scene, {5, 1, -1}, {0, 0, 2}, {2, 0, 0}, black);  // an awning over (6, 0, 0)
  test::add_point_light(&scene, {0, 3, 0}, {18, 9, 4.5f});
  const std::vector<Vec3> positions{{0, 0, 0}, {4, 0, 0}, {8, 0.0f, 0}};
  const Irradiance e = at(scene, positions, {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, with(16));
  EXPECT_NEAR(e.total(0).x, 2, 1e-4);
  EXPECT_NEAR(e.total(1).x, 18.0 / 25 * 3 / 5, 1e-4);
  ErrorRecord().add(e.total(1).x, 18.0 / 25 * 3 / 5);
  EXPECT_EQ(e.total(2), (Rgb{0, 0, 0})) << "the line to the light crosses the awning";
  EXPECT_EQ(e.variance_total[0].x, 0) << "one light, nothing random";

  scene.lights[0].kind = scene::LightKind::Directional;
  scene.lights[0].direction = normalize({1, -1, 0});
  const Irradiance sun = at(scene, positions, {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, with(16));
  EXPECT_NEAR(sun.total(0).x, 18 * std::sqrt(0.5), 1e-4);
}

TEST(Transport, AgreesWithANaivePathTracer) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}, {0.9f, 1.1f, 1}, {1.1f, 2.5f, 1.1f}};
  const std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const Irradiance e = estimate_irradiance(bvh, lights, positions, normals, with(8192, 5));
  constexpr int kPaths = 120'000;
  for (size_t i = 0; i < positions.size(); ++i) {
    const test::NaiveIrradiance naive =
        test::naive_irradiance(bvh, positions[i], normals[i], 5, kPaths, Rng(77, i));
    for (int c = 0; c < 3; ++c) {
      const double mean = naive.mean[c], variance = naive.variance[c];
      const double error = std::sqrt(variance + e.variance_total[i][c]);
      EXPECT_NEAR(e.total(static_cast<int64_t>(i))[c], mean, 4 * error)
          << "point " << i << " channel " << c;
      EXPECT_LT(e.variance_total[i][c] * static_cast<double>(e.rays), variance * kPaths)
          << "light sampling should beat chance";
    }
  }
}

TEST(Transport, LightWithoutGroupsIsTheSumOfThem) {
  const scene::Scene scene = test::furnished_room();
  const std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}}, normals{{0, 1, 0}, {1, 0, 0}};
  IrradianceOptions options = with(256);
  const Irradiance apart = at(scene, positions, normals, options);
  options.by_group = false;
  const Irradiance sum = at(scene, positions, normals, options);
  ASSERT_GT(apart.groups, 1);
  ASSERT_EQ(sum.groups, 1);
  ASSERT_EQ(sum.direct.size(), positions.size());
  for (int64_t i = 0; i < 2; ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(sum.direct_sum(i)[c], apart.direct_sum(i)[c], 1e-5f * apart.direct_sum(i)[c]);
      EXPECT_NEAR(sum.indirect_sum(i)[c], apart.indirect_sum(i)[c],
                  1e-5f * apart.indirect_sum(i)[c]);
    }
  }
  EXPECT_EQ(sum.variance, apart.variance);
}

/// Of light that starts in a closed room all is absorbed: ∫ E (1 − ρ) dA = π L A.
TEST(Transport, ConservesEnergy) {
  const float albedo[] = {0.2f, 0.7f, 0.5f, 0.3f, 0.6f, 0.4f};
  const Vec3 low{0, 0, 0}, high{3, 2, 4};
  scene::Scene scene;
  std::vector<Vec3> positions, normals;
  std::vector<double> weights;  // area the point stands for, times absorption
  double power = 0;
  const scene::Mesh box = test::box_mesh(low, high, 0, true);
  for (size_t face = 0; face < 6; ++face) {
    const Rgb color{albedo[face], albedo[face], albedo[face]};
    const int material = add_material(&scene, color, face == 3 ? Rgb{2, 2, 2} : Rgb{});
    const Vec3 corner = box.positions[4 * face], edge1 = box.positions[4 * face + 1] - corner,
               edge2 = box.positions[4 * face + 3] - corner;
    add_quad(&scene, corner, edge1, edge2, material);
    const double area = length(cross(edge1, edge2));
    if (face == 3) power = kPi * 2 * area;
    constexpr int kSide = 12;
    for (int i = 0; i < kSide * kSide; ++i) {
      positions.push_back(corner + edge1 * ((static_cast<float>(i % kSide) + 0.5f) / kSide) +
                          edge2 * ((static_cast<float>(i / kSide) + 0.5f) / kSide));
      normals.push_back(normalize(cross(edge1, edge2)));
      weights.push_back(area / (kSide * kSide) * (1 - albedo[face]));
    }
  }
  const Irradiance e = at(scene, positions, normals, with(64, 40));
  double absorbed = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    absorbed += weights[i] * e.total(static_cast<int64_t>(i)).x;
  }
  EXPECT_NEAR(absorbed, power, 0.005 * power);
  ErrorRecord().add(absorbed, power);
}

}  // namespace
}  // namespace lte::pathtrace
