// Light at vertices of cut triangles, against closed forms.
#include "lte/bake/vertex_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "tests/bake/quad_lightmap.h"
#include "tests/support/closed_forms.h"

namespace lte::bake {
namespace {

/// Lamps of 1 m² over a black floor and before a black wall of 1.5 m that meets it, as a light map
/// without noise, a layer each.
struct LampsOverCorner {
  static constexpr float kRadiance = 5, kWall = 1.5f;
  scene::Scene scene;
  std::vector<std::vector<Vec3>> lamps;
  Lightmap map;

  explicit LampsOverCorner(const std::vector<Vec3>& corners = {{1.5f, 2, 0.5f}}) {
    const int black = test::add_material(&scene, {0, 0, 0});
    test::add_quad(&scene, {0, 0, 0}, {0, 0, 4}, {4, 0, 0}, black);
    test::add_quad(&scene, {0, 0, 0}, {4, 0, 0}, {0, kWall, 0}, black);
    const int lit = test::add_material(&scene, {0, 0, 0}, Rgb{1, 0.5f, 0.25f} * kRadiance);
    for (const Vec3& at : corners) {
      const Vec3 x{1, 0, 0}, z{0, 0, 1};
      test::add_quad(&scene, at, x, z, lit);
      lamps.push_back({at, at + x, at + x + z, at + z});
    }
    map = test::quad_lightmap(scene, 64, 1);
    for (size_t lamp = 0; lamp < lamps.size(); ++lamp)
      for (const size_t quad : {size_t{0}, size_t{1}}) paint(lamp, quad);
  }

  /// Of the red light of a lamp.
  double known(const Vec3& position, const Vec3& normal, size_t lamp = 0) const {
    return kRadiance * test::polygon_irradiance(lamps[lamp], position, normal);
  }

  /// Errors at random places of the triangles of floor and wall, as VertexOptions has them, of
  /// lamps with gains.
  std::vector<double> errors(const VertexLight& found,
                             const std::vector<float>& gains = {1}) const {
    std::vector<double> out;
    double mean = 0;
    for (const bool with_mean : {false, true}) {
      Rng rng(3, 4);
      for (size_t i = 0; i < 2; ++i) {
        const scene::Mesh& mesh = found.meshes[i];
        for (const auto& corner : mesh.triangles) {
          const float u = rng.uniform(), v = (1 - u) * rng.uniform();
          const std::array<float, 3> share{1 - u - v, u, v};
          Vec3 at;
          for (size_t k = 0; k < 3; ++k) at += mesh.positions[corner[k]] * share[k];
          double light = 0, want = 0;
          for (size_t l = 0; l < lamps.size(); ++l) {
            for (size_t k = 0; k < 3; ++k) {
              light += double{gains[l] * found.layers[l].irradiance[i][corner[k]].x * share[k]};
            }
            want += double{gains[l]} * known(at, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1}, l);
          }
          if (with_mean)
            out.push_back(std::abs(light - want) / std::max(want, 0.1 * mean));
          else
            mean += want;
        }
      }
      mean /= static_cast<double>(found.triangles);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  void paint(size_t lamp, size_t quad) {
    const Placement& place = map.placements[quad];
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const int px = static_cast<int>(place.min.x * static_cast<float>(map.width)) + x;
        const int py = static_cast<int>(place.min.y * static_cast<float>(map.height)) + y;
        const Vec2 at{4 * static_cast<float>(x) / 63, 4 * static_cast<float>(y) / 63};
        // Corner 1 of a quad is along its first edge, and so is u.
        const double light = quad == 0 ? known({at.y, 0, at.x}, {0, 1, 0}, lamp)
                                       : known({at.x, at.y * kWall / 4, 0}, {0, 0, 1}, lamp);
        for (size_t c = 0; c < 3; ++c) {
          map.layers[lamp].irradiance[3 * (static_cast<size_t>(py) * map.width + px) + c] =
              static_cast<float>(light) / static_cast<float>(1 << c);
        }
      }
    }
  }
};

TEST(VertexLight, IsTheClosedFormBetweenVertices) {
  const LampsOverCorner lamp;
  VertexOptions options;
  size_t last = 0;
  for (const double bend : {0.2, 0.05, 0.02}) {
    options.bend = bend;
    const VertexLight found = vertex_light(lamp.map, options);
    EXPECT_EQ(found.triangles_before, 6);
    EXPECT_FALSE(found.limited);
    const std::vector<double> off = lamp.errors(found);
    EXPECT_LT(off[off.size() * 95 / 100], bend);
    EXPECT_LT(off.back(), 2.5 * bend);
    EXPECT_LT(found.off_p95, bend);
    EXPECT_GT(off.size(), last);
    last = off.size();
  }
  EXPECT_LT(last, 64u * 64 / 2);  // as few as it takes
  options.bend = 10;
  const std::vector<double> flat = lamp.errors(vertex_light(lamp.map, options));
  EXPECT_EQ(flat.size(), 4u);
  EXPECT_GT(flat.back(), 0.3);
}

TEST(VertexLight, OfACornerIsThatOfItsOwnSide) {
  const LampsOverCorner lamp;
  VertexOptions options;
  options.bend = 0.02;
  const VertexLight found = vertex_light(lamp.map, options);
  int64_t corners = 0;
  for (size_t i = 0; i < 2; ++i) {
    const scene::Mesh& mesh = found.meshes[i];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3& p = mesh.positions[v];
      if (p.y != 0 || p.z != 0) continue;
      const double want = lamp.known(p, i == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
      const double other = lamp.known(p, i == 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0});
      EXPECT_NEAR(double{found.total(i)[v].x}, want, 0.06 * want) << p.x;
      if (p.x > 1 && p.x < 3) {
        EXPECT_GT(std::abs(want - other), 0.2 * want);
      }
      ++corners;
    }
  }
  EXPECT_GT(corners, 8);
}

TEST(VertexLight, StopsAtTheLimit) {
  const LampsOverCorner lamp;
  const VertexLight found = vertex_light(lamp.map, {0.02, 200});
  EXPECT_TRUE(found.limited);
  EXPECT_LE(found.triangles, 200);
  EXPECT_GT(found.triangles, 100);
  EXPECT_LT(found.off_p95, 0.2);
  EXPECT_EQ(vertex_light(lamp.map, {0.02, 1}).triangles, 6);
}

const std::vector<Vec3> kTwoLamps{{1.5f, 2, 0.5f}, {2.6f, 1.6f, 2.2f}};

TEST(VertexLight, LayersAreTheClosedFormsOfTheirLampsHoweverDimmed) {
  const LampsOverCorner lamps(kTwoLamps);
  VertexOptions options;
  for (const double bend : {0.2, 0.05}) {
    options.bend = bend;
    const VertexLight found = vertex_light(lamps.map, options);
    ASSERT_EQ(found.layers.size(), 2u);
    EXPECT_EQ(found.layers[0].name, "light0");
    EXPECT_EQ(found.layers[1].name, "light1");
    EXPECT_LT(found.off_p95, bend);
    for (const VertexLayer& layer : found.layers) EXPECT_LT(layer.off_p95, bend);
    for (const std::vector<float>& gains :
         std::vector<std::vector<float>>{{1, 1}, {1, 0}, {0, 1}, {0.1f, 1}, {3, 0.2f}}) {
      const std::vector<double> off = lamps.errors(found, gains);
      EXPECT_LT(off[off.size() * 95 / 100], bend) << gains[0] << ' ' << gains[1];
      EXPECT_LT(off.back(), 2.5 * bend) << gains[0] << ' ' << gains[1];
    }
  }
}

TEST(VertexLight, OfALayerIsThatOfItsLampAlone) {
  const LampsOverCorner lamps(kTwoLamps);
  VertexOptions whole;
  whole.bend = 10;  // triangles as they are
  const VertexLight found = vertex_light(lamps.map, whole);
  for (size_t l = 0; l < 2; ++l) {
    for (const float gain : {1.0f, 0.3f}) {
      Lightmap alone = lamps.map;
      alone.layers = {lamps.map.layers[l]};
      for (float& value : alone.layers[0].irradiance) value *= gain;
      const VertexLight one = vertex_light(alone, whole);
      for (size_t i = 0; i < found.meshes.size(); ++i) {
        const std::vector<Rgb>& layer = found.layers[l].irradiance[i];
        const std::vector<Rgb> light = one.total(i);
        ASSERT_EQ(layer.size(), light.size());
        for (size_t v = 0; v < layer.size(); ++v) {
          for (int c = 0; c < 3; ++c) {
            if (gain == 1) {
              EXPECT_EQ(layer[v][c], light[v][c]);
            }
            EXPECT_NEAR(gain * layer[v][c], light[v][c], 1e-4f * gain * layer[v][c] + 1e-9f);
          }
        }
      }
    }
  }
}

TEST(VertexLight, IsCutWhereLayersBendAndTheirSumDoesNot) {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0},
                 test::add_material(&scene, {0.5f, 0.5f, 0.5f}));
  for (int k = 0; k < 2; ++k) test::add_point_light(&scene, {0, 1, 0}, {1, 1, 1});
  Lightmap map = test::quad_lightmap(scene, 32, 1);
  for (size_t i = 0; i < 3 * map.pixels(); ++i) {
    const float x = static_cast<float>(i / 3 % 32) / 31;
    map.layers[0].irradiance[i] = 1 + 4 * x * x;
    map.layers[1].irradiance[i] = 6 - map.layers[0].irradiance[i];
  }
  VertexOptions options;
  options.bend = 0.05;
  const VertexLight found = vertex_light(map, options);
  EXPECT_GT(found.triangles, 8);
  EXPECT_LT(found.off_p95, 0.01);
  for (const VertexLayer& layer : found.layers) EXPECT_LT(layer.off_p95, 0.05);
  for (const Rgb& light : found.total(0)) EXPECT_NEAR(light.x, 6, 0.05);
  Lightmap sum = map;
  sum.layers = {{"light", map.total()}};
  EXPECT_EQ(vertex_light(sum, options).triangles, 2);
}

TEST(VertexLight, OfInstancesIsTheirOwn) {
  scene::Scene scene;
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, gray);
  test::add_point_light(&scene, {0, 1, 0}, {1, 1, 1});
  test::add_instance(&scene, scene.meshes[0],
                     test::translation({3, 0, 0}) * test::scaling({-1, 1, 1}));
  Lightmap map = test::quad_lightmap(scene, 8, 1);
  for (size_t i = 0; i < map.pixels(); ++i) {
    const bool first = static_cast<int>(i % static_cast<size_t>(map.width)) < 8;
    for (size_t c = 0; c < 3; ++c) map.layers[0].irradiance[3 * i + c] = first ? 2.0f : 6.0f;
  }
  const VertexLight found = vertex_light(map, {});
  ASSERT_EQ(found.meshes.size(), 2u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(found.total(0)[v].x, 2, 1e-5);
    EXPECT_NEAR(found.total(1)[v].x, 6, 1e-5);
  }
}

}  // namespace
}  // namespace lte::bake
