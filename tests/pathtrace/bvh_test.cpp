#include "lte/pathtrace/bvh.h"

#include <functional>
#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/cpu_isa.h"
#include "lte/base/random.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/ray_offset.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

TEST(Bvh, ReportsDistanceBarycentricsAndFrontNormal) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  add_quad(&scene, {10, 0, 0}, {0, 2, 0}, {0, 0, 2}, material);  // another, out of the way
  add_quad(&scene, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, material);   // front: +z
  const Bvh bvh(scene);
  const Hit front = bvh.intersect({{1.5f, 0.5f, 3}, {0, 0, -2}});
  ASSERT_TRUE(front.valid());
  EXPECT_FLOAT_EQ(front.t, 1.5f);
  EXPECT_EQ(front.instance, 1);
  EXPECT_EQ(front.triangle, 0u);
  EXPECT_NEAR(front.u, 0.5f, 1e-6f);  // position = u (2,0,0) + v (2,2,0)
  EXPECT_NEAR(front.v, 0.25f, 1e-6f);
  EXPECT_EQ(front.normal, (Vec3{0, 0, 1}));
  const Hit back = bvh.intersect({{0.5f, 1.5f, -3}, {0, 0, 1}});
  ASSERT_TRUE(back.valid());
  EXPECT_EQ(back.triangle, 1u);
  EXPECT_EQ(back.normal, (Vec3{0, 0, 1})) << "the front's, whatever side is hit";
  EXPECT_FALSE(bvh.intersect({{5, 5, 3}, {0, 0, -1}}).valid());
}

TEST(Bvh, RespectsTheRayInterval) {
  scene::Scene scene;
  add_quad(&scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, add_material(&scene, {1, 1, 1}));
  const Bvh bvh(scene);
  const Vec3 origin{0.1f, 0.2f, 1}, down{0, 0, -1};
  EXPECT_TRUE(bvh.occluded({origin, down}));
  EXPECT_TRUE(bvh.occluded({origin, down, 0.9f, 1.1f}));
  EXPECT_FALSE(bvh.occluded({origin, down, 0, 0.99f}));
  EXPECT_FALSE(bvh.occluded({origin, down, 1.01f, 10}));
  EXPECT_FALSE(bvh.intersect({origin, down, 0, 0.99f}).valid());
  EXPECT_FALSE(bvh.intersect({origin, down, 1.01f, 10}).valid());
}

TEST(Bvh, FrontStaysFrontUnderMirroringAndShear) {
  const Vec3 corner{0, 0, 0}, edge1{1, 0, 0}, edge2{0, 1, 0};
  const Affine turn = test::rotation(normalize({1, 2, 3}), 0.7f);
  Affine shear;
  shear.m[0][2] = 0.8f;
  shear.m[2][1] = -0.5f;
  for (const Affine& transform :
       {turn, test::scaling({2, 2, -0.5f}) * turn, turn * test::scaling({-1, 1, 1}),
        shear * turn * test::scaling({1, -3, 2}), turn * test::scaling({-1, -1, -1})}) {
    scene::Scene scene;
    const int material = add_material(&scene, {1, 1, 1});
    add_instance(&scene, test::quad_mesh(corner, edge1, edge2, material), transform);
    const Bvh bvh(scene);
    const Vec3 target = transform.point({0.3f, 0.4f, 0});
    // The front of the untransformed quad looks at +z; its image is on the side of the transformed
    // point (., ., 1).
    const Vec3 in_front = transform.point({0.3f, 0.4f, 1});
    const Hit hit = bvh.intersect({in_front, target - in_front});
    ASSERT_TRUE(hit.valid());
    EXPECT_NEAR(hit.t, 1, 1e-5f);
    EXPECT_GT(dot(hit.normal, in_front - target), 0);
    EXPECT_NEAR(length(hit.normal), 1, 1e-6f);
    EXPECT_NEAR(dot(hit.normal, normalize(transform.vector(edge1))), 0, 1e-5f);
    EXPECT_NEAR(dot(hit.normal, normalize(transform.vector(edge2))), 0, 1e-5f);
  }
}

TEST(Bvh, SkipsSingularInstancesAndKeepsTheIndicesOfOthers) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  const auto quad = test::quad_mesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
  add_instance(&scene, quad, test::scaling({1, 0, 1}));
  add_instance(&scene, quad, test::scaling({0, 0, 0}));
  add_instance(&scene, quad, test::translation({0, 0, -5}));
  const Bvh bvh(scene);
  const Hit hit = bvh.intersect({{0.1f, 0.1f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit.valid());
  EXPECT_EQ(hit.instance, 2);
  EXPECT_FLOAT_EQ(hit.t, 6);
}

TEST(Bvh, EmptyScenesAndMeshesMissEverything) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  const Bvh empty(scene);
  EXPECT_FALSE(empty.intersect({{0, 0, 0}, {0, 0, 1}}).valid());
  EXPECT_FALSE(empty.occluded({{0, 0, 0}, {0, 0, 1}}));
  EXPECT_TRUE(empty.bounds().empty());
  scene::Mesh hollow;
  hollow.material = material;
  add_instance(&scene, hollow);
  EXPECT_FALSE(Bvh(scene).intersect({{0, 0, 0}, {0, 0, 1}}).valid());
}

/// Nearest intersection by trying each world triangle (Möller and Trumbore, in double).
double brute_force(const scene::Scene& scene, const Ray& ray, int* instance) {
  double best = INFINITY;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const auto& mesh = scene.meshes[scene.instances[i].mesh];
    for (const auto& corners : mesh.triangles) {
      double p[3][3];
      for (int c = 0; c < 3; ++c) {
        const Vec3 world = scene.instances[i].to_world.point(mesh.positions[corners[c]]);
        for (int axis = 0; axis < 3; ++axis) p[c][axis] = world[axis];
      }
      double e1[3], e2[3], s[3], d[3];
      for (int axis = 0; axis < 3; ++axis) {
        e1[axis] = p[1][axis] - p[0][axis];
        e2[axis] = p[2][axis] - p[0][axis];
        s[axis] = ray.origin[axis] - p[0][axis];
        d[axis] = ray.direction[axis];
      }
      const auto det = [](const double* a, const double* b, const double* c) {
        return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
      };
      double minus_d[3] = {-d[0], -d[1], -d[2]};
      const double whole = det(e1, e2, minus_d);
      if (whole == 0) continue;
      const double u = det(s, e2, minus_d) / whole, v = det(e1, s, minus_d) / whole,
                   t = det(e1, e2, s) / whole;
      if (u < 0 || v < 0 || u + v > 1 || t < 0 || t >= best) continue;
      best = t;
      *instance = static_cast<int>(i);
    }
  }
  return best;
}

/// Twenty small triangles around random places.
scene::Mesh random_triangles(const std::function<Vec3()>& random_vector, int material) {
  scene::Mesh mesh;
  mesh.material = material;
  for (uint32_t t = 0; t < 20; ++t) {
    const Vec3 center = random_vector();
    for (int c = 0; c < 3; ++c) mesh.positions.push_back(center + random_vector() * 0.3f);
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

TEST(Bvh, MatchesBruteForceOverRandomInstancedTriangles) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  Rng rng(5);
  const auto random_vector = [&rng] {
    return Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  };
  for (int i = 0; i < 12; ++i) {
    const scene::Mesh mesh = random_triangles(random_vector, material);
    add_instance(&scene, mesh,
                 test::translation(random_vector()) *
                     test::rotation(normalize(random_vector()), rng.uniform(0, 6)) *
                     test::scaling(random_vector()));
  }
  const Bvh bvh(scene);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin = random_vector() * 2;
    const Ray ray{origin, normalize(random_vector() * 0.7f - origin)};
    int instance = scene::kNone;
    const double expected = brute_force(scene, ray, &instance);
    const Hit hit = bvh.intersect(ray);
    ASSERT_EQ(hit.valid(), std::isfinite(expected)) << "ray " << i;
    ASSERT_EQ(bvh.occluded(ray), hit.valid());
    if (!hit.valid()) continue;
    ++hits;
    ASSERT_NEAR(hit.t, expected, 2e-5) << "ray " << i;
    ASSERT_EQ(hit.instance, instance) << "ray " << i;
  }
  EXPECT_GT(hits, 500);
}

TEST(Bvh, IsAsPreciseAMillionMetresAway) {
  const Vec3 far{1e6f, -1e6f, 5e5f};
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  add_instance(&scene, test::quad_mesh({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, material),
               test::translation(far));
  const Bvh bvh(scene);
  for (int i = 0; i < 16; ++i) {
    const float x = 0.25f * static_cast<float>(i) - 2;
    const Hit hit = bvh.intersect({far + Vec3{x, 1, 2}, {0, 0, -1}});
    ASSERT_TRUE(hit.valid());
    EXPECT_FLOAT_EQ(hit.t, 2);
  }
}

TEST(OffsetOrigin, LeavesTheSurfaceByMoreThanRoundingAndStaysNear) {
  for (const float magnitude : {1e-3f, 1.0f, 7.3f, 1e6f}) {
    const Vec3 position = Vec3{0.3f, 1, -0.7f} * magnitude;
    const Vec3 side = normalize({1, 2, -2});
    const Vec3 moved = offset_origin(position, side);
    const float height = dot(moved - position, side);
    EXPECT_GT(height, magnitude * 4e-7f);
    EXPECT_LT(height, magnitude * 4e-6f);
  }
}

/// Meshes that are not moved need no tree of their own; those that others may share have one.
TEST(Bvh, WithoutTreesOfItsMeshesFindsTheSameHits) {
  scene::Scene scene;
  const int material = add_material(&scene, {1, 1, 1});
  Rng rng(9);
  const auto random_vector = [&rng] {
    return Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  };
  for (int i = 0; i < 9; ++i) {
    const scene::Mesh mesh = random_triangles(random_vector, material);
    add_instance(&scene, mesh, i % 3 == 2 ? test::translation(random_vector()) : Affine());
  }
  scene.instances.push_back({0, test::translation({0.1f, 0, 0})});  // the first one twice
  const Bvh flat(scene);
  const auto nested = Bvh::with_own_meshes(scene);
  std::set<int> met;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin = random_vector() * 2;
    const Ray ray{origin, normalize(random_vector() * 0.7f - origin)};
    const Hit a = flat.intersect(ray), b = nested->intersect(ray);
    ASSERT_EQ(a.instance, b.instance);
    ASSERT_EQ(flat.occluded(ray), a.valid());
    if (!a.valid()) continue;
    met.insert(a.instance);
    ASSERT_EQ(a.triangle, b.triangle);
    ASSERT_EQ(a.t, b.t);
    ASSERT_EQ(a.u, b.u);
    ASSERT_EQ(a.normal, b.normal);
  }
  EXPECT_EQ(met.size(), 10u);
}

/// The meshes' trees outlive the scene and the tree that they were made for.
TEST(Bvh, OnTheMeshesOfAnotherFindsTheSameHits) {
  auto first = std::make_unique<scene::Scene>(test::furnished_room());
  auto trees = Bvh::with_own_meshes(*first);
  scene::Scene moved = *first;
  moved.instances[2].to_world = test::translation({1.2f, 0.2f, 2.1f});
  moved.instances.erase(moved.instances.begin() + 1);
  moved.meshes.push_back(moved.meshes[3]);  // another lamp of the same form
  moved.instances.push_back({5, test::translation({0, -0.5f, 0}), 0});
  const std::vector<int> tree_of_mesh = {0, 1, 2, 3, 4, 3};
  const Bvh shared(moved, *trees, tree_of_mesh);
  trees.reset();
  first.reset();
  const Bvh own(moved);
  Rng rng(5, 0);
  const auto uniform = [&] { return static_cast<float>(rng.next_u64() >> 40) * 0x1p-24f; };
  int hits_of_added = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{{4 * uniform(), 2.5f * uniform(), 3 * uniform()},
                  {uniform() - 0.5f, uniform() - 0.5f, uniform() - 0.5f}};
    const Hit a = shared.intersect(ray), b = own.intersect(ray);
    ASSERT_EQ(a.instance, b.instance);
    ASSERT_EQ(a.triangle, b.triangle);
    ASSERT_EQ(a.t, b.t);
    ASSERT_EQ(a.normal, b.normal);
    hits_of_added += a.instance == 4 ? 1 : 0;
  }
  EXPECT_GT(hits_of_added, 10);
  EXPECT_THROW(Bvh(moved, own, tree_of_mesh), Error) << "its meshes borrow from its scene";
}

TEST(Bvh, TakesPacketsOfTheInstructionSetThatIsAskedFor) {
  const scene::Scene scene = test::furnished_room();
  const int width = Bvh(scene).handles().packet_width;
  const std::string asked = wanted_cpu_isa();
  if (asked == "baseline") {
    EXPECT_EQ(width, 4);
  } else if (asked == "avx2") {
    EXPECT_LE(width, 8);
  }
#if defined(__x86_64__)
  const bool avx512 = __builtin_cpu_supports("avx512vl") != 0;
  if (__builtin_cpu_supports("avx2") && asked != "baseline") {
    EXPECT_EQ(width, avx512 && asked != "avx2" ? 16 : 8);
  }
#endif
}

}  // namespace
}  // namespace lte::pathtrace
