// Faults of geometry: cubes with faults added one by one, so that every count is known.
#include "lte/scene/inspect/inspect.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace lte::scene {
namespace {

/// A cube of edge 1, fronts outward, 12 triangles over 8 vertices.
Mesh cube(int material = 0) {
  Mesh mesh;
  mesh.material = material;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2)});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Affine moved(float x) {
  Affine out;
  out.m[0][3] = x;
  return out;
}

Scene one(Mesh mesh) {
  Scene scene;
  scene.name = "faults";
  scene.materials.resize(2);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({0, {}, kNone});
  return scene;
}

TEST(Inspect, ASoundCubeHasNoFaults) {
  const GeometryFaults report = inspect(one(cube()));
  EXPECT_TRUE(report.inspected);
  EXPECT_EQ(report.degenerate_triangles + report.duplicate_triangles + report.opposite_triangles +
                report.conflicting_triangles + report.near_duplicate_vertices + report.open_edges +
                report.branching_edges + report.flipped_edges,
            0);
  EXPECT_EQ(report.closed_shells, 1);
  EXPECT_EQ(report.inward_shells, 0);
}

TEST(Inspect, CountsOpenEdgesAndTheirLength) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);  // a face of edge 1
  const GeometryFaults report = inspect(one(mesh));
  EXPECT_EQ(report.open_edges, 4);
  EXPECT_NEAR(report.open_edge_length_m, 4, 1e-6);
  EXPECT_EQ(report.closed_shells, 0);
}

TEST(Inspect, MeshesThatMeetCloseEachOthersEdges) {
  Mesh box = cube(), lid = cube();
  lid.triangles = {box.triangles[0], box.triangles[1]};
  box.triangles.erase(box.triangles.begin(), box.triangles.begin() + 2);
  Scene scene = one(box);
  scene.meshes.push_back(lid);
  scene.instances.push_back({1, {}, kNone});
  EXPECT_EQ(inspect(scene).open_edges, 0);
  EXPECT_EQ(inspect(scene).closed_shells, 1);
  scene.instances[1].to_world = moved(0.01f);
  EXPECT_EQ(inspect(scene).open_edges, 8);
}

TEST(Inspect, CountsFlippedTrianglesAndInwardShells) {
  Mesh mesh = cube();
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_EQ(inspect(one(mesh)).flipped_edges, 3);
  mesh = cube();
  for (auto& corner : mesh.triangles) std::swap(corner[0], corner[1]);
  EXPECT_EQ(inspect(one(mesh)).inward_shells, 1);
  EXPECT_EQ(inspect(one(mesh)).flipped_edges, 0);
  Scene mirrored = one(cube());
  mirrored.instances[0].to_world.m[0][0] = -1;
  EXPECT_EQ(inspect(mirrored).inward_shells, 0) << "a mirroring instance keeps the front outside";
}

TEST(Inspect, BranchingEdgesAreCounted) {
  Mesh mesh = cube();
  mesh.positions.push_back({0.5f, -1, -1});
  mesh.triangles.push_back({0, 1, 8});  // a fin on the edge 0-1
  const GeometryFaults report = inspect(one(mesh));
  EXPECT_EQ(report.branching_edges, 1);
  EXPECT_EQ(report.open_edges, 2);
}

TEST(Inspect, CountsTrianglesWithoutArea) {
  Mesh mesh = cube();
  mesh.positions.push_back({0.5f, 0, 0});
  mesh.triangles.push_back({0, 8, 1});  // on a line
  mesh.triangles.push_back({3, 3, 5});
  EXPECT_EQ(inspect(one(mesh)).degenerate_triangles, 2);
  EXPECT_EQ(inspect(one(cube())).degenerate_triangles, 0);
}

TEST(Inspect, CountsDuplicatesByWinding) {
  Mesh mesh = cube();
  mesh.triangles.push_back({2, 1, 0});  // triangle 0 from another corner
  mesh.triangles.push_back({0, 1, 2});  // and turned over
  const GeometryFaults report = inspect(one(mesh));
  EXPECT_EQ(report.duplicate_triangles, 1);
  EXPECT_EQ(report.opposite_triangles, 1);
  EXPECT_EQ(report.open_edges, 0) << "coincident triangles count once for edges";
}

TEST(Inspect, CountsFacesOfNeighboursBackToBack) {
  // Two cubes side by side: the face between them is there twice, back to back.
  Scene scene = one(cube());
  scene.instances.push_back({0, moved(1), kNone});
  EXPECT_EQ(inspect(scene).opposite_triangles, 2);
  EXPECT_EQ(inspect(scene).duplicate_triangles, 0);
}

TEST(Inspect, CountsTwoMaterialsInOnePlace) {
  Scene scene = one(cube(0));
  scene.meshes.push_back(cube(1));
  scene.instances.push_back({1, {}, kNone});
  EXPECT_EQ(inspect(scene).conflicting_triangles, 12);
}

TEST(Inspect, NearVerticesCloseCracks) {
  Mesh mesh = cube();
  // Triangle 5 gets vertices of its own, a millionth of the diagonal off.
  for (uint32_t& corner : mesh.triangles[5]) {
    mesh.positions.push_back(mesh.positions[corner] + Vec3{5e-7f, 0, 0});
    corner = static_cast<uint32_t>(mesh.positions.size() - 1);
  }
  const Scene scene = one(mesh);
  const GeometryFaults report = inspect(scene);
  EXPECT_EQ(report.near_duplicate_vertices, 3);
  EXPECT_EQ(report.open_edges, 0);
  EXPECT_EQ(inspect(scene, 0).open_edges, 6) << "identical positions alone";
}

TEST(Inspect, NearVerticesAgreeWithBruteForce) {
  // Points without triangles of their own but one: only their distances matter.
  Mesh mesh;
  uint64_t state = 5;
  const auto uniform = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<float>(state >> 40) / static_cast<float>(1 << 24);
  };
  for (int i = 0; i < 600; ++i) mesh.positions.push_back({uniform(), uniform(), uniform()});
  mesh.positions.push_back({0, 0, 0});
  mesh.positions.push_back({1, 1, 1});
  mesh.triangles = {{0, 1, 2}};
  constexpr double kTolerance = 0.03;
  std::vector<size_t> set(mesh.positions.size());
  for (size_t i = 0; i < set.size(); ++i) set[i] = i;
  for (size_t i = 0; i < set.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (length(mesh.positions[i] - mesh.positions[j]) > kTolerance * std::sqrt(3.0)) continue;
      const size_t from = set[i], to = set[j];
      for (size_t& s : set) s = s == from ? to : s;
    }
  }
  std::sort(set.begin(), set.end());
  const auto sets = std::unique(set.begin(), set.end()) - set.begin();
  ASSERT_LT(sets, 602);
  EXPECT_EQ(inspect(one(mesh), kTolerance).near_duplicate_vertices, 602 - sets);
}

TEST(Inspect, FarOffAndHugeScenesAndSinglePoints) {
  Scene scene = one(cube());
  for (Vec3& p : scene.meshes[0].positions) p = p * 1e30f;
  EXPECT_EQ(inspect(scene).closed_shells, 1);
  scene = one(cube());
  for (Vec3& p : scene.meshes[0].positions) p = Vec3{0, 0, 0};
  EXPECT_EQ(inspect(scene).degenerate_triangles, 12);
}

TEST(Inspect, FindsNearVerticesWhereverTheyLie) {
  // Each of many vertices has one partner half a tolerance away, across whatever boundary.
  constexpr double kTolerance = 1e-5;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 1);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 1}};  // the diagonal
  const auto step = static_cast<float>(0.5 * kTolerance * std::sqrt(3.0));
  constexpr int kPairs = 20000;
  for (int i = 0; i < kPairs; ++i) {
    const Vec3 p{place(random), place(random), place(random)};
    Vec3 q = p;
    (i % 3 == 0 ? q.x : i % 3 == 1 ? q.y : q.z) += step;
    mesh.positions.push_back(p);
    mesh.positions.push_back(q);
  }
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(inspect(one(mesh), kTolerance).near_duplicate_vertices, kPairs);
  EXPECT_EQ(inspect(one(mesh), kTolerance / 4).near_duplicate_vertices, 0);
}

}  // namespace
}  // namespace lte::scene
