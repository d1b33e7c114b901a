// Triangles that are halved: without cracks, and back again.
#include "lte/bake/refined_scene.h"

#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/scene/triangle.h"
#include "tests/support/scenes.h"

namespace lte::bake {
namespace {

using Place = std::tuple<float, float, float>;

double area_of(const RefinedScene& refined) {
  double out = 0;
  for (const Leaf& leaf : refined.leaves()) {
    const auto& positions = refined.scene().meshes[leaf.instance].positions;
    out += scene::area(
        {positions[leaf.vertex[0]], positions[leaf.vertex[1]], positions[leaf.vertex[2]]});
  }
  return out;
}

/// A room whose walls are meshes of their own, and a sphere in it.
scene::Scene room_of_walls() {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  const scene::Mesh room = test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true);
  for (size_t t = 0; t < room.triangles.size(); t += 2) {
    scene::Mesh wall = room;
    wall.triangles = {room.triangles[t], room.triangles[t + 1]};
    test::add_instance(&scene, wall);
  }
  test::add_instance(&scene, test::inward_sphere_mesh(0.5f, 3, white),
                     test::translation({1.75f, 1.25f, 1.5f}));
  return scene;
}

std::vector<uint32_t> some_leaves(const RefinedScene& refined, Rng* rng) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < refined.leaves().size(); ++i)
    if (rng->uniform() < 0.2f) out.push_back(i);
  return out;
}

TEST(RefinedScene, HasNoCracks) {
  RefinedScene refined(room_of_walls());
  const double before = area_of(refined);
  Rng rng(1, 2);
  for (int round = 0; round < 6; ++round) EXPECT_TRUE(refined.halve(some_leaves(refined, &rng)));
  EXPECT_GT(refined.leaves().size(), 2000u);
  EXPECT_NEAR(area_of(refined), before, 1e-4 * before);
  std::set<Place> corners;
  std::map<uint32_t, Place> of_point;
  const auto at = [&](const Leaf& leaf, size_t k) {
    return refined.scene().instances[leaf.instance].to_world.point(
        refined.scene().meshes[leaf.instance].positions[leaf.vertex[k]]);
  };
  for (const Leaf& leaf : refined.leaves()) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = at(leaf, k);
      corners.insert({p.x, p.y, p.z});
      EXPECT_EQ(of_point.try_emplace(leaf.point[k], p.x, p.y, p.z).first->second,
                Place(p.x, p.y, p.z));
    }
  }
  for (const Leaf& leaf : refined.leaves()) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 middle = (at(leaf, k) + at(leaf, (k + 1) % 3)) * 0.5f;
      EXPECT_FALSE(corners.contains({middle.x, middle.y, middle.z}));
    }
  }
}

TEST(RefinedScene, IsAsItWasWhereItWouldExceedTheLimit) {
  RefinedScene refined(room_of_walls()), other(room_of_walls());
  const auto expect_same = [&] {
    ASSERT_EQ(refined.leaves().size(), other.leaves().size());
    for (size_t i = 0; i < refined.leaves().size(); ++i) {
      const Leaf &a = refined.leaves()[i], &b = other.leaves()[i];
      EXPECT_EQ(a.instance, b.instance);
      EXPECT_EQ(a.point, b.point);
      for (size_t k = 0; k < 3; ++k) {
        const Vec3& p = refined.scene().meshes[a.instance].positions[a.vertex[k]];
        const Vec3& q = other.scene().meshes[b.instance].positions[b.vertex[k]];
        EXPECT_TRUE(p.x == q.x && p.y == q.y && p.z == q.z);
      }
    }
  };
  Rng rng(5, 6);
  for (int round = 0; round < 4; ++round) {
    const std::vector<uint32_t> which = some_leaves(refined, &rng);
    const size_t before = refined.leaves().size();
    // One more than the leaves themselves: what fits their edges exceeds it.
    EXPECT_FALSE(refined.halve(which, before + which.size() + 1));
    EXPECT_FALSE(refined.halve(some_leaves(refined, &rng), before));
    expect_same();
    EXPECT_TRUE(refined.halve(which));
    other.halve(which);
    EXPECT_GT(refined.leaves().size(), before + which.size() + 1);
    expect_same();
    EXPECT_TRUE(refined.halve({}, refined.leaves().size()));
  }
}

}  // namespace
}  // namespace lte::bake
