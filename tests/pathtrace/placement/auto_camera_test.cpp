// The automatic camera on scenes of each kind.
#include "lte/pathtrace/placement/auto_camera.h"

#include <gtest/gtest.h>

#include "lte/pathtrace/render.h"
#include "tests/support/machine.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

/// All instances of a scene after a transform of the world.
scene::Scene moved(scene::Scene scene, const Affine& by) {
  for (scene::Instance& instance : scene.instances) instance.to_world = by * instance.to_world;
  return scene;
}

bool is_within(const Vec3& p, const Bounds& bounds) {
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] <= bounds.low[axis] || p[axis] >= bounds.high[axis]) return false;
  return true;
}

/// What an instance covers of a picture, as shares of its width and height.
struct Cover {
  float width = 0, height = 0;
  bool whole = true;  ///< no part of it is at the picture's edge
};
Cover cover(const Bvh& bvh, const scene::Camera& camera, float aspect, int instance) {
  constexpr int kSide = 128;
  int low[2] = {kSide, kSide}, high[2] = {-1, -1};
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3 direction = camera.direction((static_cast<float>(x) + 0.5f) / kSide,
                                              (static_cast<float>(y) + 0.5f) / kSide, aspect);
      if (bvh.intersect({camera.origin, direction}).instance != instance) continue;
      const int at[2] = {x, y};
      for (int i = 0; i < 2; ++i) {
        low[i] = std::min(low[i], at[i]);
        high[i] = std::max(high[i], at[i]);
      }
    }
  }
  const auto size = [&](int i) { return static_cast<float>(high[i] - low[i] + 1) / kSide; };
  const bool whole = low[0] > 0 && low[1] > 0 && high[0] < kSide - 1 && high[1] < kSide - 1;
  return {size(0), size(1), whole};
}

/// A box of 0.55 m whose side towards +z is missing.
scene::Scene open_box() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh box = test::box_mesh({0, 0, 0}, {0.55f, 0.55f, 0.55f}, white, true);
  box.triangles.resize(10);  // without its last face
  add_instance(&scene, box);
  add_instance(&scene, test::box_mesh({0.1f, 0, 0.1f}, {0.25f, 0.3f, 0.25f}, white, false));
  return scene;
}

TEST(AutoCamera, StandsInsideTheRoomAndSeesIt) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const scene::Camera camera = auto_camera(bvh);
  EXPECT_GT(camera.origin.y, 1.1f);
  EXPECT_LT(camera.origin.y, 2.4f);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(camera.origin[axis], bvh.bounds().low[axis]);
    EXPECT_LT(camera.origin[axis], bvh.bounds().high[axis]);
  }
  const GBuffer g = trace_gbuffer(bvh, camera, 48, 32);
  double mean = 0, near = 0;
  for (size_t i = 0; i < g.depth.size(); ++i) {
    ASSERT_EQ(g.mask[i], 1);
    mean += g.depth[i] / static_cast<double>(g.depth.size());
    near += g.depth[i] < 0.8f ? 1.0 / static_cast<double>(g.depth.size()) : 0;
  }
  EXPECT_GT(mean, 1.5) << "looks across the room, not at a wall";
  EXPECT_LT(near, 0.1);
  const scene::Camera again = auto_camera(Bvh(scene));
  EXPECT_EQ(again.origin, camera.origin);
  EXPECT_EQ(again.target, camera.target);
}

TEST(AutoCamera, SeesAnOpenBoxFromOutsideThroughItsOpenSide) {
  for (const float scale : {1.0f, 1000.0f}) {
    for (int turns = 0; turns < 4; ++turns) {
      const float angle = kPi / 2 * static_cast<float>(turns);
      const scene::Scene scene = moved(
          open_box(), test::scaling({scale, scale, scale}) * test::rotation({0, 1, 0}, angle));
      const Bvh bvh(scene);
      const scene::Camera camera = auto_camera(bvh);
      // +z goes to sin(angle) along x and cos(angle) along z.
      const Vec3 open{std::sin(angle), 0, std::cos(angle)};
      const float beyond = dot(camera.origin - bvh.bounds().center(), open);
      EXPECT_GT(beyond, 0.3f * scale) << turns << " quarter turns";
      EXPECT_NEAR(dot(normalize(camera.target - camera.origin), open), -1, 1e-5);
      const GBuffer g = trace_gbuffer(bvh, camera, 64, 64);
      const auto seen = std::count(g.mask.begin(), g.mask.end(), 1);
      // The opening fills 0.975 of each side.
      EXPECT_NEAR(static_cast<double>(seen) / (64 * 64), 0.975 * 0.975, 0.04);
      EXPECT_EQ(g.mask[0], 0) << "the walls' edges are in view";
    }
  }
}

TEST(AutoCamera, StandsOnAStageThatIsMuchWiderThanHigh) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh box = test::box_mesh({0, 0, 0}, {9, 2.5f, 5}, white, true);
  box.triangles.resize(10);
  add_instance(&scene, box);
  const Bvh bvh(scene);
  EXPECT_TRUE(is_within(auto_camera(bvh).origin, bvh.bounds()));
}

TEST(AutoCamera, FillsTheFrameWithAnObjectOfAnyShape) {
  for (const Vec3& size : {Vec3{1, 1, 1}, {0.2f, 2, 0.3f}, {3, 0.1f, 2}, {300, 100, 200}}) {
    for (const float aspect : {1.0f, 16 / 9.0f, 0.5f}) {
      scene::Scene scene;
      const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
      add_instance(&scene,
                   test::box_mesh(Vec3{7, -3, 2} - size, Vec3{7, -3, 2} + size, white, false));
      const Bvh bvh(scene);
      const Cover seen = cover(bvh, auto_camera(bvh, 0, aspect), aspect, 0);
      EXPECT_NEAR(std::max(seen.width, seen.height), kOutsideFill, 0.03)
          << size.x << " " << size.y << " " << size.z << ", aspect " << aspect;
      EXPECT_TRUE(seen.whole);
    }
  }
}

TEST(AutoCamera, FramesAnObjectAndNotItsGroundBackdropAndLamp) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  const int lamp = add_material(&scene, {0, 0, 0}, {9, 9, 9});
  add_instance(&scene, test::box_mesh({-0.2f, 0, -0.2f}, {0.2f, 0.5f, 0.2f}, white, false));
  add_quad(&scene, {-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, white);  // up
  add_quad(&scene, {-5, 0, -5}, {10, 0, 0}, {0, 6, 0}, white);   // towards +z
  add_quad(&scene, {-1, 4, -1}, {2, 0, 0}, {0, 0, 2}, lamp);
  const Bvh bvh(scene);
  const Cover seen = cover(bvh, auto_camera(bvh), 1, 0);
  EXPECT_NEAR(std::max(seen.width, seen.height), kOutsideFill, 0.03);
  EXPECT_TRUE(seen.whole);
}

TEST(AutoCamera, SeesTheFrontOfAPlate) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  add_quad(&scene, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, white);  // its front is towards −z
  const Bvh bvh(scene);
  EXPECT_LT(auto_camera(bvh).origin.z, 0);
}

/// A room of 5 x 2.6 x 4 m with a doorway in a fenced garden of 40 m, and outer walls.
scene::Scene house_in_a_garden() {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh room = test::box_mesh({0, 0, 0}, {5, 2.6f, 4}, white, true);
  room.triangles.resize(10);
  add_instance(&scene, room);
  add_quad(&scene, {0, 0, 4}, {0, 2.6f, 0}, {4, 0, 0}, white);  // beside a doorway of 1 m
  scene::Mesh outer = test::box_mesh({-0.2f, 0, -0.2f}, {5.2f, 2.8f, 4}, white, false);
  outer.triangles.resize(8);
  add_instance(&scene, outer);
  scene::Mesh garden = test::box_mesh({-20, 0, -20}, {20, 6, 20}, white, true);
  garden.triangles.erase(garden.triangles.begin() + 6, garden.triangles.begin() + 8);  // no top
  add_instance(&scene, garden);
  return scene;
}

TEST(AutoCamera, IsInTheHouseAndNotInItsGarden) {
  const scene::Scene scene = house_in_a_garden();
  const Bvh bvh(scene);
  const Bounds room{{0, 0, 0}, {5, 2.6f, 4}};
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Vec3 eye = auto_camera(bvh, seed).origin;
    EXPECT_TRUE(is_within(eye, room)) << eye.x << " " << eye.y << " " << eye.z;
    EXPECT_GT(eye.y, 1.19f);
    EXPECT_LT(eye.y, 1.71f);
  }
}

TEST(AutoCamera, StandsOnTheFloorAndNotOnTheFurniture) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  add_instance(&scene, test::box_mesh({0, 0, 0}, {6, 3.4f, 5}, white, true));
  for (const float x : {0.5f, 2.5f, 4.5f})
    add_instance(&scene, test::box_mesh({x, 0.4f, 0.5f}, {x + 1, 0.9f, 4.5f}, white, false));
  const Bvh bvh(scene);
  for (uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_LT(auto_camera(bvh, seed).origin.y, 1.71f);
    EXPECT_GT(auto_camera(bvh, seed).origin.y, 1.19f);
  }
}

TEST(AutoCamera, IsTheSameInCentimetres) {
  const scene::Scene metres = test::furnished_room();
  const scene::Scene centimetres = moved(metres, test::scaling({100, 100, 100}));
  const Bvh small(metres), large(centimetres);
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const scene::Camera a = auto_camera(small, seed), b = auto_camera(large, seed);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(b.origin[axis], 100 * a.origin[axis], 0.1);
      EXPECT_NEAR(b.target[axis], 100 * a.target[axis], 0.1);
    }
  }
}

TEST(AutoCamera, StandsBetweenWallsWithoutACeiling) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  scene::Mesh room = test::box_mesh({0, 0, 0}, {7, 2.6f, 6}, white, true);
  room.triangles.erase(room.triangles.begin() + 6, room.triangles.begin() + 8);
  add_instance(&scene, room);
  const Bvh bvh(scene);
  EXPECT_TRUE(is_within(auto_camera(bvh).origin, bvh.bounds()));
  // A crate of the same form is an object.
  const scene::Scene crate = moved(scene, test::scaling({0.1f, 0.1f, 0.1f}));
  const Bvh low(crate);
  EXPECT_GT(auto_camera(low).origin.y, low.bounds().high.y);
}

TEST(AutoCamera, SeesAVesselFromOutside) {
  const scene::Scene scene = test::vessel();
  const Bvh bvh(scene);
  EXPECT_GT(length(auto_camera(bvh).origin), 41);
}

TEST(AutoCamera, SeesAMachineFromOutside) {
  const scene::Scene scene = test::machine();
  const Bvh bvh(scene);
  EXPECT_FALSE(is_within(auto_camera(bvh).origin, bvh.bounds()));
  const FreeSpace space = survey(bvh);
  EXPECT_GT(space.outward, 0.9f);
  EXPECT_GT(space.standing, 0.0f) << "one could stand in its cells";
  EXPECT_FALSE(space.has_rooms());
}

TEST(FreeSpace, MeasuresWhereOneCouldStand) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  add_instance(&scene, test::box_mesh({0, 0, 0}, {8, 2.5f, 5}, white, true));
  EXPECT_NEAR(survey(Bvh(scene)).standing, 7.4 * 4.4 / 40, 0.05) << "0.3 m from the walls";
  // A wardrobe that reaches the ceiling takes its floor and 0.3 m around it.
  add_instance(&scene, test::box_mesh({3, 0, 0}, {5, 2.5f, 2.5f}, white, false));
  EXPECT_NEAR(survey(Bvh(scene)).standing, (7.4 * 4.4 - 2.6 * 2.5) / 40, 0.05);
  scene::Scene low;
  add_material(&low, {0.7f, 0.7f, 0.7f});
  add_instance(&low, test::box_mesh({0, 0, 0}, {8, 1.2f, 5}, white, true));
  add_instance(&low, test::box_mesh({0, 1.3f, 0}, {8, 2.5f, 5}, white, true));
  EXPECT_EQ(survey(Bvh(low)).standing, 0) << "two layers that are too low";
}

TEST(AutoCamera, PrefersTheRoomWithTheLamp) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  const int lamp = add_material(&scene, {0, 0, 0}, {9, 9, 9});
  const Bounds lit{{6, 0, 0}, {9.5f, 2.5f, 3}};
  add_instance(&scene, test::box_mesh({0, 0, 0}, {5, 2.5f, 5}, white, true));
  add_instance(&scene, test::box_mesh(lit.low, lit.high, white, true));
  add_quad(&scene, {7, 2.45f, 1}, {1, 0, 0}, {0, 0, 1}, lamp);
  const Bvh bvh(scene);
  for (uint64_t seed = 0; seed < 5; ++seed)
    EXPECT_TRUE(is_within(auto_camera(bvh, seed).origin, lit)) << "seed " << seed;
}

TEST(AutoCamera, HasAViewOfNothing) {
  const scene::Scene empty;
  const scene::Camera camera = auto_camera(Bvh(empty));
  EXPECT_TRUE(is_finite(camera.target) && is_finite(camera.origin));
  EXPECT_GT(length(camera.target - camera.origin), 0);
}

const char* unit_of(const scene::Scene& scene, float scale) {
  const scene::Scene scaled = moved(scene, test::scaling({scale, scale, scale}));
  return likely_unit(survey(Bvh(scaled)).room_height);
}

TEST(LikelyUnit, IsToldByTheHeightOfRooms) {
  const scene::Scene room = test::furnished_room();
  EXPECT_EQ(unit_of(room, 1), nullptr);
  EXPECT_EQ(unit_of(room, 10), nullptr) << "a church";
  EXPECT_STREQ(unit_of(room, 100), "centimetres");
  EXPECT_STREQ(unit_of(room, 1000), "millimetres");
  EXPECT_STREQ(unit_of(open_box(), 1000), "centimetres") << "550 units high";
  EXPECT_STREQ(unit_of(test::hall_of_lamps(), 100), "centimetres");
}

TEST(LikelyUnit, IsNotGuessedFromSolidsAndSkies) {
  scene::Scene tower, sky;
  const int white = add_material(&tower, {0.7f, 0.7f, 0.7f});
  add_instance(&tower, test::box_mesh({-40, 0, -40}, {40, 400, 40}, white, false));
  EXPECT_EQ(unit_of(tower, 1), nullptr);
  add_material(&sky, {0.7f, 0.7f, 0.7f});
  add_instance(&sky, test::inward_sphere_mesh(300, 4, 0));
  add_quad(&sky, {-200, 0, -200}, {0, 0, 400}, {400, 0, 0}, 0);
  EXPECT_EQ(unit_of(sky, 1), nullptr);
}

TEST(FreeSpace, KnowsWhichSideIsOpen) {
  const FreeSpace space = survey(Bvh(open_box()));
  for (size_t side = 0; side < 5; ++side) EXPECT_LT(space.open[side], kClosed);
  EXPECT_GT(space.open[5], kOpen);
  EXPECT_TRUE(space.surrounded());
  EXPECT_FALSE(space.closed());
  const scene::Scene room = test::furnished_room();
  EXPECT_TRUE(survey(Bvh(room)).closed());
  EXPECT_NEAR(survey(Bvh(room)).room_height, 2.5, 1e-3);
}

}  // namespace
}  // namespace lte::pathtrace
