#include "datagen/homes/mesh/mesh_parts.h"

#include <gtest/gtest.h>

#include "datagen/homes/furniture/furniture.h"
#include "tests/datagen/homes/mesh_checks.h"

namespace lte::datagen::homes {
namespace {

using test::area_of;
using test::closedness_fault;
using test::enclosed_volume;

std::vector<Vec2> half_circle(float radius, int chords) {
  std::vector<Vec2> points{{0, -radius}};
  for (int i = 1; i < chords; ++i) {
    const float t = kPi * (static_cast<float>(i) / static_cast<float>(chords) - 0.5f);
    points.push_back({radius * std::cos(t), radius * std::sin(t)});
  }
  points.push_back({0, radius});
  return points;
}

TEST(RoundedBox, IsClosedAndHasTheVolumeAndAreaOfABoxWithRoundedEdges) {
  const double a = 0.7, b = 0.3, c = 0.5, r = 0.06;
  const double u = a - 2 * r, v = b - 2 * r, w = c - 2 * r;
  // Steiner's formula: inner box, slabs, quarter cylinders, eighths of a sphere.
  const double volume = u * v * w + 2 * r * (u * v + v * w + w * u) + M_PI * r * r * (u + v + w) +
                        4 * M_PI / 3 * r * r * r;
  const double area = 2 * (u * v + v * w + w * u) + 2 * M_PI * r * (u + v + w) + 4 * M_PI * r * r;
  for (const int bevel : {1, 2, 5, 12}) {
    for (const float cell : {INFINITY, 0.04f}) {
      const Mesh box = rounded_box({1, 2, 3}, {1.7f, 2.3f, 3.5f}, 0.06f, bevel, cell);
      EXPECT_EQ(closedness_fault(box), "") << bevel;
      const double tolerance = 0.03 / (bevel * bevel) + 1e-4;
      EXPECT_NEAR(enclosed_volume(box), volume, tolerance * volume) << bevel;
      EXPECT_NEAR(area_of(box), area, 3 * tolerance * area) << bevel;
      EXPECT_NEAR(volume_of(box), enclosed_volume(box), 1e-5);
    }
  }
  const Mesh ball = rounded_box({-1, -1, -1}, {1, 1, 1}, 5, 16);  // the radius is cut to a half
  EXPECT_EQ(closedness_fault(ball), "");
  EXPECT_NEAR(enclosed_volume(ball), 4 * M_PI / 3, 0.01);
}

TEST(Lathe, SphereCylinderAndRingAreClosedWithTheirClosedForms) {
  const Mesh sphere = lathe(half_circle(0.5f, 64), 128);
  EXPECT_EQ(closedness_fault(sphere), "");
  EXPECT_NEAR(enclosed_volume(sphere), M_PI / 6, 2e-3);
  EXPECT_NEAR(area_of(sphere), M_PI, 6e-3);
  const Mesh cylinder = lathe({{0, 1}, {0.3f, 1}, {0.3f, 3}, {0, 3}}, 96);
  EXPECT_EQ(closedness_fault(cylinder), "");
  EXPECT_NEAR(enclosed_volume(cylinder), M_PI * 0.09 * 2, 1e-3);
  EXPECT_NEAR(area_of(cylinder), 2 * M_PI * 0.09 + 2 * M_PI * 0.3 * 2, 5e-3);
  const Mesh ring = lathe({{0.4f, 0}, {0.6f, 0}, {0.6f, 0.1f}, {0.4f, 0.1f}}, 96, true);
  EXPECT_EQ(closedness_fault(ring), "");
  EXPECT_NEAR(enclosed_volume(ring), M_PI * (0.36 - 0.16) * 0.1, 1e-4);
}

TEST(Tube, StraightAndBentAreClosedWithTheVolumeOfPappus) {
  const Mesh straight = tube({{0, 0, 0}, {1, 1, 0}}, 0.05f, 64);
  EXPECT_EQ(closedness_fault(straight), "");
  EXPECT_NEAR(enclosed_volume(straight), M_PI * 0.0025 * std::sqrt(2.0), 1e-4);
  std::vector<Vec3> arc;
  for (int i = 0; i <= 64; ++i) {
    const float t = kPi / 2 * static_cast<float>(i) / 64;
    arc.push_back({std::cos(t), 0.2f, std::sin(t)});
  }
  const Mesh bent = tube(arc, 0.05f, 64);
  EXPECT_EQ(closedness_fault(bent), "");
  EXPECT_NEAR(enclosed_volume(bent), M_PI * 0.0025 * M_PI / 2, 1e-4);
}

TEST(Sweep, MitredFrameAndOpenMouldingHaveTheirVolume) {
  const std::vector<Vec2> square{{0, 0}, {0.1f, 0}, {0.1f, 0.05f}, {0, 0.05f}};
  for (const bool reversed : {false, true}) {
    std::vector<Vec2> path{{0, 0}, {2, 0}, {2, -1}, {0, -1}};  // the profile is inside
    if (reversed) path = {{0, 0}, {0, -1}, {2, -1}, {2, 0}};   // and here outside
    const Mesh frame = sweep(path, square, true);
    EXPECT_EQ(closedness_fault(frame), "");
    const double ring = reversed ? 2.2 * 1.2 - 2 : 2 - 1.8 * 0.8;
    EXPECT_NEAR(enclosed_volume(frame), ring * 0.05, 1e-5);
  }
  const Mesh corner = sweep({{0, 0}, {2, 0}, {2, -1}}, square, false);
  EXPECT_EQ(closedness_fault(corner), "");
  EXPECT_NEAR(enclosed_volume(corner), (2 * 0.1 + 1 * 0.1 - 0.1 * 0.1) * 0.05, 1e-5);
}

TEST(Sheet, IsClosedWithThicknessTimesArea) {
  const Mesh flat = sheet(
      7, 5,
      [](float u, float v) {
        return Vec3{2 * u, 0, -v};
      },
      0.01f);
  EXPECT_EQ(closedness_fault(flat), "");
  EXPECT_NEAR(enclosed_volume(flat), 0.02, 1e-6);
  const Mesh wavy = sheet(
      40, 30,
      [](float u, float v) {
        return Vec3{u, 0.1f * std::sin(6 * u), v};
      },
      0.01f);
  EXPECT_EQ(closedness_fault(wavy), "");
  EXPECT_GT(enclosed_volume(wavy), 0.0);
}

TEST(Cushion, IsClosedOutwardAndWithinItsSize) {
  const Mesh pillow = cushion({0.6f, 0.2f, 0.4f}, 48);
  EXPECT_EQ(closedness_fault(pillow), "");
  const double share = enclosed_volume(pillow) / (0.6 * 0.2 * 0.4);
  EXPECT_GT(share, 0.45);  // an ellipsoid has 0.52, a box 1
  EXPECT_LT(share, 0.9);
  const Vec3 size = bounds_of(pillow).extent();
  EXPECT_NEAR(size.x, 0.612f, 1e-3);
  EXPECT_NEAR(size.z, 0.412f, 1e-3);
}

TEST(MeshTools, DisplacedMirroredAndSquaredOffMeshesStayClosedAndOutward) {
  Mesh box = rounded_box({-1, 0, -1}, {1, 1, 1}, 0.1f, 3, 0.1f);
  displace(&box, [](const Vec3& p) { return Vec3{0, 0.05f * std::sin(9 * p.x), 0}; });
  EXPECT_EQ(closedness_fault(box), "");
  Mesh mirrored;
  append(&mirrored, box, scaling({-1, 1, 2}));
  EXPECT_EQ(closedness_fault(mirrored), "");
  EXPECT_NEAR(enclosed_volume(mirrored), 2 * enclosed_volume(box), 1e-3);
  Mesh round = lathe({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 256);
  square_off(&round, 4);
  EXPECT_EQ(closedness_fault(round), "");
  // Area of |x|⁴ + |z|⁴ = 1 is Γ(1/4)² / (2 √π).
  EXPECT_NEAR(enclosed_volume(round), std::pow(std::tgamma(0.25), 2) / (2 * std::sqrt(M_PI)), 0.01);
  EXPECT_EQ((rotation(1, 90).vector({0, 0, 1})).x, 1.0f);
}

/// Every piece is put together from closed parts: so is the whole, but for panels.
TEST(Furniture, HasFiniteUvsAndPositiveVolumeAndStandsOnTheFloor) {
  for (uint64_t seed = 0; seed < 6; ++seed) {
    scene::Scene scene;
    Palette palette(&scene, {8}, seed);
    Kit kit{&palette, Rng(seed), {0.6f}, 10, 0.7f};
    std::vector<Piece> pieces;
    for (const auto make : {make_bedside, make_wardrobe, make_dresser, make_chair, make_stool,
                            make_desk_chair, make_coffee_table, make_side_table, make_desk,
                            make_bookshelf, make_media_bench, make_console, make_fridge, make_tub,
                            make_vanity, make_toilet, make_floor_lamp, make_table_lamp})
      pieces.push_back(make(&kit));
    pieces.push_back(make_bed(&kit, seed % 2 == 0));
    pieces.push_back(make_sofa(&kit, 1 + static_cast<int>(seed % 3)));
    pieces.push_back(make_kitchen_run(&kit, 2 + 0.4f * static_cast<float>(seed), seed % 2 == 0));
    pieces.push_back(make_plant(&kit, 1));
    for (int thing = 0; thing <= static_cast<int>(Thing::Soap); ++thing)
      pieces.push_back(make_thing(&kit, static_cast<Thing>(thing)));
    for (const Piece& piece : pieces) {
      EXPECT_NEAR(piece.bounds().low.y, 0, 0.004) << piece.name << ", seed " << seed;
      EXPECT_FALSE(piece.name.empty());
      double volume = 0;
      for (const auto& [material, mesh] : piece.meshes) {
        ASSERT_EQ(mesh.positions.size(), mesh.uvs[0].size());
        for (const Vec3& p : mesh.positions) ASSERT_TRUE(is_finite(p)) << piece.name;
        for (const Vec2& uv : mesh.uvs[0])
          ASSERT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y)) << piece.name;
        if (mesh.triangles.size() > 2) {
          EXPECT_GT(volume_of(mesh), 0) << piece.name;
        }
        if (mesh.triangles.size() > 2) volume += enclosed_volume(mesh);  // not a lone panel
      }
      EXPECT_GT(volume, 0) << piece.name;
      const Vec3 size = piece.bounds().extent();
      EXPECT_LT(volume, 1.2 * size.x * size.y * size.z) << piece.name;
    }
  }
}

}  // namespace
}  // namespace lte::datagen::homes
