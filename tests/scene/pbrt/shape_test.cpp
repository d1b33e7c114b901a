// PBRT: shapes against closed forms.
#include <set>

#include "lte/scene/import/subdivision.h"
#include "lte/scene/surface.h"
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::area_of;
using test::expect_near;
using test::front;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtShape : public test::PbrtTest {};

/// Every triangle of the instance faces away from `center` (sign 1) or towards it (-1).
void expect_facing(const Scene& scene, const Vec3& center, float sign) {
  const Mesh& mesh = scene.meshes.at(0);
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Surface s = evaluate_surface(scene, 0, i, 1 / 3.f, 1 / 3.f, 0);
    ASSERT_GT(sign * dot(s.normal, s.position - center), 0) << "triangle " << i;
  }
}

TEST_F(PbrtShape, SphereLiesWithinItsChordErrorAndFacesOutwards) {
  const Scene scene = load_world("Shape \"sphere\" \"float radius\" 2");
  EXPECT_NEAR(area_of(scene), 16 * M_PI, 0.002 * 16 * M_PI);
  double closest = 10;
  const Mesh& mesh = scene.meshes[0];
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(length(p), 2, 1e-5);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
    for (const Vec3& middle : {(p + q) * 0.5f, (q + r) * 0.5f, (r + p) * 0.5f})
      closest = std::min<double>(closest, length(middle));
  }
  EXPECT_GT(closest, 2 * (1 - 0.002));  // both angles of a diagonal at most 0.001 each
  expect_facing(scene, {0, 0, 0}, 1);
}

TEST_F(PbrtShape, PartsOfSpheresHaveTheAreaOfTheirZones) {
  // A zone's area is 2 pi r h, whatever its place (Archimedes); half of the turn is half of it.
  const Scene scene = load_world(
      "Shape \"sphere\" \"float radius\" 3 \"float zmin\" -1 \"float zmax\" 2 \"float phimax\" "
      "180");
  EXPECT_NEAR(area_of(scene), M_PI * 3 * 3, 0.002 * M_PI * 9);
  for (const Vec3& p : scene.meshes[0].positions) {
    EXPECT_GT(p.z, -1.0001);
    EXPECT_LT(p.z, 2.0001);
    EXPECT_GT(p.y, -1e-5);
  }
}

TEST_F(PbrtShape, CylinderAndDisk) {
  const Scene cylinder = load_world(
      "Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" 4 \"float phimax\" "
      "90");
  EXPECT_NEAR(area_of(cylinder), M_PI * 3, 0.001 * M_PI * 3);  // 2 pi r h / 4
  const Scene whole = load_world("Shape \"cylinder\"");
  EXPECT_NEAR(area_of(whole), 4 * M_PI, 0.001 * 4 * M_PI);
  for (uint32_t i = 0; i < whole.meshes[0].triangles.size(); ++i) {
    const Surface s = evaluate_surface(whole, 0, i, 1 / 3.f, 1 / 3.f, 0);
    ASSERT_GT(s.normal.x * s.position.x + s.normal.y * s.position.y, 0);
  }
  const Scene disk = load_world("Shape \"disk\" \"float radius\" 2 \"float height\" 5");
  EXPECT_NEAR(area_of(disk), 4 * M_PI, 0.0015 * 4 * M_PI);
  expect_near(front(disk), {0, 0, 1});
  EXPECT_EQ(disk.meshes[0].positions[0].z, 5);
  const Scene ring = load_world("Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1");
  EXPECT_NEAR(area_of(ring), 3 * M_PI, 0.0015 * 3 * M_PI);
}

TEST_F(PbrtShape, QuadricsHaveNoTrianglesWithoutArea) {
  const Scene scene = load_world("Shape \"sphere\"\nShape \"disk\"\n");
  for (size_t i = 0; i < 2; ++i) {
    const Mesh& mesh = scene.meshes[i];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      ASSERT_GT(area(world_triangle(mesh, {}, t)), 1e-7) << i << " " << t;
  }
}

TEST_F(PbrtShape, QuadricsHaveTheTextureCoordinatesOfPbrt) {
  const Mesh sphere = load_world("Shape \"sphere\" \"float radius\" 2").meshes[0];
  for (size_t i = 0; i < sphere.positions.size(); ++i) {
    const Vec3 p = sphere.positions[i] * 0.5f;
    const Vec2 uv = sphere.uvs[0][i];
    // v runs from the pole at -z to that at +z by the polar angle.
    ASSERT_NEAR(uv.y, 1 - std::acos(std::clamp(p.z, -1.f, 1.f)) / M_PI, 2e-4);
    if (std::hypot(p.x, p.y) < 1e-3) continue;
    const double phi = std::atan2(p.y, p.x),
                 turn = phi < -1e-6 ? phi / (2 * M_PI) + 1 : phi / (2 * M_PI);
    ASSERT_NEAR(std::remainder(uv.x - turn, 1.0), 0, 1e-4);
  }
}

TEST_F(PbrtShape, OrientationFollowsReverseOrientationAndNotHandedness) {
  const std::string sphere = "Shape \"sphere\"\n";
  expect_facing(load_world(sphere), {0, 0, 0}, 1);
  expect_facing(load_world("ReverseOrientation\n" + sphere), {0, 0, 0}, -1);
  expect_facing(load_world("Scale -1 1 1\n" + sphere), {0, 0, 0}, 1);
  expect_facing(load_world("Scale 1 -1 1\nReverseOrientation\n" + sphere), {0, 0, 0}, -1);
  expect_facing(load_world("ReverseOrientation ReverseOrientation\n" + sphere), {0, 0, 0}, 1);
}

TEST_F(PbrtShape, NormalsDecideTheFrontOfTriangles) {
  const auto facing = [&](const std::string& before, const std::string& normals) {
    return front(load_world(before +
                            "\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] "
                            "\"integer indices\" [0 1 2] " +
                            normals))
        .z;
  };
  const std::string down = "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
  EXPECT_EQ(facing("", ""), 1);
  EXPECT_EQ(facing("", down), -1);
  EXPECT_EQ(facing("ReverseOrientation", down), 1);
  EXPECT_EQ(facing("Scale -1 1 1", ""), 1);
  EXPECT_EQ(facing("Scale -1 1 1", down), -1);
}

TEST_F(PbrtShape, TriangleMeshKeepsVerticesAndCoordinates) {
  const Scene scene = load_world(
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0  1 1 0] \"point2 uv\" "
      "[0 0 1 0 0 1 1 1] \"integer indices\" [0 1 2 2 1 3]");
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_THAT(mesh.triangles,
              ElementsAre(std::array<uint32_t, 3>{0, 1, 2}, std::array<uint32_t, 3>{2, 1, 3}));
  EXPECT_EQ(mesh.uvs[0][3].y, 1);
  EXPECT_THAT(scene.ignored, IsEmpty());
  // One triangle may leave its indices out.
  EXPECT_EQ(load_world("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]").triangle_count(),
            1);
}

TEST_F(PbrtShape, FlatPatchesAreTwoTrianglesAndBentOnesAGrid) {
  // Corner order p00 p10 p01 p11.
  const Scene flat = load_world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]");
  EXPECT_EQ(flat.triangle_count(), 2);
  EXPECT_NEAR(area_of(flat), 6, 1e-6);
  expect_near(front(flat), {0, 0, 1});
  // z = x y over the unit square: the area is the integral of sqrt(1 + x² + y²), here by midpoints.
  const Scene bent = load_world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]");
  double exact = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j)
      exact += std::sqrt(1 + std::pow((i + 0.5) / kSteps, 2) + std::pow((j + 0.5) / kSteps, 2));
  }
  EXPECT_NEAR(area_of(bent), exact / kSteps / kSteps, 1e-3);
  for (const Vec3& p : bent.meshes[0].positions) EXPECT_NEAR(p.z, p.x * p.y, 1e-6);
  expect_near(front(load_world("ReverseOrientation Shape \"bilinearmesh\" \"point3 P\" "
                               "[0 0 0 2 0 0 0 3 0 2 3 0]")),
              {0, 0, -1});
  expect_near(front(load_world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0] "
                               "\"normal N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1]")),
              {0, 0, -1});
}

/// The regular octahedron. Loop's masks by hand: a corner has valence 4, beta 3/32, so its limit is
/// p/2 + (sum of its ring)/8, and the ring's sum is 0. After one level the new vertex of the edge
/// ab is 3/8 (a + b) (the corners across cancel); its ring is 5/8 a, 5/8 b and four of its kind
/// whose sum is 3/4 (a + b); its limit is half of itself plus a twelfth of the ring.
TEST(LoopSubdivision, OctahedronHasItsLimitSurface) {
  TriangleMesh octahedron{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                          {}};
  for (const uint32_t x : {0u, 1u}) {
    for (const uint32_t y : {2u, 3u}) {
      for (const uint32_t z : {4u, 5u})
        octahedron.triangles.push_back((x + y + z) % 2 == 0 ? std::array<uint32_t, 3>{x, y, z}
                                                            : std::array<uint32_t, 3>{y, x, z});
    }
  }
  for (int levels = 0; levels <= 3; ++levels) {
    const TriangleMesh mesh = loop_subdivide(octahedron, levels, "test");
    EXPECT_EQ(mesh.triangles.size(), 8u << (2 * levels));
    EXPECT_EQ(mesh.positions.size(), (4u << (2 * levels)) + 2);  // Euler's formula
    for (size_t corner = 0; corner < 6; ++corner) {
      float largest = 0;
      for (const Vec3& p : mesh.positions)
        largest = std::max(largest, dot(p, octahedron.positions[corner]));
      EXPECT_NEAR(largest, 0.5f, 1e-6f) << levels;
    }
    const float mid = 0.1875f + 1.375f / 12;
    const auto is_mid = [&](const Vec3& p) { return length(p - Vec3{mid, mid, 0}) < 1e-5f; };
    EXPECT_EQ(std::any_of(mesh.positions.begin(), mesh.positions.end(), is_mid), levels > 0);
  }
}

/// A boundary is a cubic B-spline of its own: along a straight one nothing moves, and the limit of
/// a corner p with neighbours a and b is 3/5 p + (a + b)/5.
TEST(LoopSubdivision, BoundariesAreSplines) {
  const TriangleMesh square{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const TriangleMesh limit = loop_subdivide(square, 0, "test");
  expect_near(limit.positions[0], {0.8f, 0.8f, 0});
  expect_near(limit.positions[2], {3.2f, 3.2f, 0});
  const TriangleMesh fine = loop_subdivide(square, 2, "test");
  EXPECT_EQ(fine.triangles.size(), 32u);
  for (const Vec3& p : fine.positions) EXPECT_EQ(p.z, 0);
  // By hand. pbrt's limit of a boundary, (1/5, 3/5, 1/5), is not quite its spline's, so levels move
  // it.
  expect_near(fine.positions[0], {0.675f, 0.675f, 0});
}

TEST(LoopSubdivision, RefusesWhatIsNoSurface) {
  const std::vector<Vec3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  const auto error = [&](std::vector<std::array<uint32_t, 3>> triangles) {
    return test::error_of([&] { loop_subdivide({p, std::move(triangles)}, 1, "a.pbrt:3"); });
  };
  EXPECT_THAT(error({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}),
              HasSubstr("a.pbrt:3: the edge between vertices 0 and 1 has more than two"));
  EXPECT_THAT(error({{0, 1, 2}, {0, 3, 4}}), HasSubstr("more than one boundary"));
  EXPECT_THAT(error({{0, 0, 2}}), HasSubstr("no length"));
}

TEST_F(PbrtShape, LoopsubdivIsOrientedAgainstItsWindingAsInPbrt) {
  const std::string tetrahedron =
      "Shape \"loopsubdiv\" \"integer levels\" 2 \"integer indices\" [0 2 1 0 1 3 1 2 3 0 3 2] "
      "\"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1]\n";  // wound outwards
  const Scene scene = load_world(tetrahedron);
  EXPECT_EQ(scene.triangle_count(), 64);
  expect_facing(scene, {0.25f, 0.25f, 0.25f}, -1);
  expect_facing(load_world("ReverseOrientation\n" + tetrahedron), {0.25f, 0.25f, 0.25f}, 1);
}

TEST_F(PbrtShape, UnknownShapesAndAlphaAreNoted) {
  const Scene scene = load_world("Shape \"curve\" \"point3 P\" [0 0 0]\n" + test::kTriangle +
                                 "Shape \"sphere\" \"float alpha\" 0\n\n"
                                 "Shape \"sphere\" \"texture alpha\" \"a\" \"float bend\" 3");
  EXPECT_THAT(ignored(scene), ElementsAre("Shape \"curve\" (scene.pbrt:2)",
                                          "alpha of a shape (2 times, first at scene.pbrt:4)",
                                          "parameter \"bend\" of Shape \"sphere\" (scene.pbrt:6)"));
}

}  // namespace
}  // namespace lte::scene
