// The atlas of a light map, and where its texels lie.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/bake/bake.h"
#include "lte/scene/triangle.h"
#include "tests/bake/density.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"

namespace lte::bake {
namespace {

/// Whether a point of the atlas, in pixels, lies inside a triangle, by signs of areas.
bool inside(const Atlas& atlas, size_t instance, size_t triangle, double x, double y) {
  const scene::Mesh& mesh = atlas.scene.meshes[instance];
  double signs[3];
  for (size_t k = 0; k < 3; ++k) {
    const Vec2& a = mesh.uvs[1][mesh.triangles[triangle][k]];
    const Vec2& b = mesh.uvs[1][mesh.triangles[triangle][(k + 1) % 3]];
    const double ax = double{a.x} * atlas.width, ay = double{a.y} * atlas.height;
    const double bx = double{b.x} * atlas.width, by = double{b.y} * atlas.height;
    signs[k] = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
  }
  constexpr double kEdge = 1e-3;
  return (signs[0] > kEdge && signs[1] > kEdge && signs[2] > kEdge) ||
         (signs[0] < -kEdge && signs[1] < -kEdge && signs[2] < -kEdge);
}

TEST(Atlas, GivesNoPixelToTwoTriangles) {
  scene::Scene scene = test::furnished_room();
  test::add_instance(&scene, test::inward_sphere_mesh(0.3f, 2, 0), test::translation({2, 1, 1}));
  const Atlas atlas = make_atlas(scene, density(12));
  int64_t covered = 0;
  for (int y = 0; y < atlas.height; ++y) {
    for (int x = 0; x < atlas.width; ++x) {
      int count = 0;
      for (size_t i = 0; i < atlas.scene.meshes.size(); ++i) {
        const Placement& place = atlas.placements[i];
        const double u = (x + 0.5) / atlas.width, v = (y + 0.5) / atlas.height;
        if (u < double{place.min.x} || u > double{place.max.x} || v < double{place.min.y} ||
            v > double{place.max.y})
          continue;
        for (size_t t = 0; t < atlas.scene.meshes[i].triangles.size(); ++t)
          count += inside(atlas, i, t, x + 0.5, y + 0.5) ? 1 : 0;
      }
      ASSERT_LE(count, 1) << x << ", " << y;
      covered += count;
    }
  }
  double area = 0;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      area += scene::area(scene::world_triangle(mesh, instance.to_world, t));
  }
  // A sphere cannot lie flat.
  EXPECT_NEAR(static_cast<double>(covered), area * 12 * 12, 0.1 * area * 12 * 12);
  EXPECT_EQ(atlas.lost_triangles, 0);
}

TEST(Atlas, KeepsShapesAndTrianglesOfInstances) {
  const scene::Scene scene = test::furnished_room();
  const Atlas atlas = make_atlas(scene, density(8));
  ASSERT_EQ(atlas.scene.meshes.size(), scene.instances.size());
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& from = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const scene::Mesh& to = atlas.scene.meshes[i];
    ASSERT_EQ(from.triangles.size(), to.triangles.size());
    for (size_t t = 0; t < from.triangles.size(); ++t)
      for (size_t k = 0; k < 3; ++k)
        EXPECT_EQ(from.positions[from.triangles[t][k]], to.positions[to.triangles[t][k]]);
  }
}

scene::Scene quad_with_uv1(float shift) {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  for (int i = 0; i < 2; ++i) {
    scene::Mesh mesh =
        test::quad_mesh({3.0f * static_cast<float>(i), 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
    const float left = 0.5f * static_cast<float>(i) * shift;
    mesh.uvs[1] = {{left, 0}, {left + 0.4f, 0}, {left + 0.4f, 0.4f}, {left, 0.4f}};
    test::add_instance(&scene, mesh);
  }
  return scene;
}

TEST(Atlas, KeepsOwnUvsUnlessTheyOverlap) {
  AtlasOptions keep = density(10);
  keep.keep_uvs = true;
  const Atlas kept = make_atlas(quad_with_uv1(1), keep);
  EXPECT_TRUE(kept.kept_uvs);
  EXPECT_FLOAT_EQ(kept.scene.meshes[1].uvs[1][0].x, 0.5f);
  EXPECT_EQ(kept.width, 25);
  const scene::Scene overlapping = quad_with_uv1(0);
  EXPECT_EQ(test::message_of([&] { make_atlas(overlapping, keep); }),
            "--set keep_uvs: TEXCOORD_1 of mesh \"quad\" overlaps");
  keep.keep_uvs = false;
  EXPECT_FALSE(make_atlas(overlapping, keep).kept_uvs);
}

TEST(Atlas, RefusesWhatCannotBeBaked) {
  scene::Scene scene = test::furnished_room();
  EXPECT_THAT(test::message_of([&] { make_atlas(scene, density(3000)); }),
              testing::HasSubstr("more than 16384"));
  for (scene::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p.y = p.z = 0;
  EXPECT_THAT(test::message_of([&] { make_atlas(scene, density(8)); }),
              testing::HasSubstr("no triangle has an area"));
}

TEST(Texels, PlacesLieInTheirTrianglesAndPixels) {
  const scene::Scene scene = test::furnished_room();
  const Layout layout = make_layout(scene, density(6));
  double parts = 0;
  for (const Fragment& f : layout.texels.fragments) parts += double{f.area};
  double area = 0;
  for (size_t i = 0; i < layout.atlas.scene.meshes.size(); ++i) {
    for (uint32_t t = 0; t < layout.atlas.scene.meshes[i].triangles.size(); ++t)
      area += scene::area(
          scene::world_triangle(layout.atlas.scene.meshes[i], scene.instances[i].to_world, t));
  }
  EXPECT_NEAR(parts, area * 36, 0.05 * area * 36);
  for (size_t i = 0; i < layout.texels.size(); ++i) {
    for (const float u : {0.0f, 0.3f, 0.999f}) {
      const TexelPlace place = place_in(layout.atlas, layout.texels, i, {u, u, 1 - u});
      const Vec3 way = place.position - layout.texels.position[i];
      EXPECT_LT(length(way), 1.6f * layout.texels.edge[i]);
      EXPECT_LT(std::abs(dot(way, layout.texels.normal[i])), 1e-4f);
    }
  }
}

}  // namespace
}  // namespace lte::bake
