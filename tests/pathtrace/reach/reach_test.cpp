// What pruning keeps and drops, against scenes whose answer is plain and against long runs.
#include "lte/pathtrace/reach/reach.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/parallel.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "tests/support/every_light.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_point_light;
using test::add_quad;

/// A lit room [0, 4] × [0, 2.5] × [0, 3] m with an empty cube of 1 m on its floor: five walls of
/// two sides each, the fifth with a slit of that width (metres) all along its top.
scene::Scene room_with_cupboard(float slit) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  const int light = add_material(&scene, {0.5f, 0.5f, 0.5f}, {9, 9, 9});
  add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  add_quad(&scene, {1.5f, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, light);  // x × z = −y: down
  const float x = 2.4f, z = 1.4f;
  add_quad(&scene, {x, 1, z}, {1, 0, 0}, {0, 0, 1}, white);  // top
  add_quad(&scene, {x, 0, z}, {0, 0, 1}, {0, 1, 0}, white);  // the four sides
  add_quad(&scene, {x + 1, 0, z}, {0, 0, 1}, {0, 1, 0}, white);
  add_quad(&scene, {x, 0, z}, {1, 0, 0}, {0, 1, 0}, white);
  add_quad(&scene, {x, 0, z + 1}, {1, 0, 0}, {0, 1 - slit, 0}, white);
  return scene;
}

/// Points of the floor on a grid, those inside the cupboard told apart.
struct FloorPoints {
  FloorPoints() {
    for (int i = 0; i < 20; ++i) {
      for (int j = 0; j < 15; ++j) {
        const Vec3 p{0.1f + 0.2f * static_cast<float>(i), 0, 0.1f + 0.2f * static_cast<float>(j)};
        positions.push_back(p);
        normals.push_back({0, 1, 0});
        inside.push_back(p.x > 2.4f && p.x < 3.4f && p.z > 1.4f && p.z < 2.4f ? 1 : 0);
      }
    }
  }
  std::vector<Vec3> positions, normals;
  std::vector<uint8_t> inside;
};

std::vector<uint8_t> complement(std::vector<uint8_t> values) {
  for (uint8_t& value : values) value = value ? 0 : 1;
  return values;
}

TEST(Reach, DropsTheInsideOfAClosedCupboardAndNothingElse) {
  const scene::Scene scene = room_with_cupboard(0);
  const Bvh bvh(scene);
  const FloorPoints floor;
  const std::vector<uint8_t> keep = reached(bvh, floor.positions, floor.normals, Sides::Front, {});
  EXPECT_EQ(keep, complement(floor.inside));
}

TEST(Reach, KeepsWhatASlitOfAHundredthLights) {
  const scene::Scene scene = room_with_cupboard(0.01f);
  const Bvh bvh(scene);
  const FloorPoints floor;
  const std::vector<uint8_t> keep = reached(bvh, floor.positions, floor.normals, Sides::Front, {});
  EXPECT_EQ(keep, std::vector<uint8_t>(keep.size(), 1));
}

TEST(Reach, KeepsACupboardWithAFaintLampOfItsOwn) {
  scene::Scene scene = room_with_cupboard(0);
  add_point_light(&scene, {2.9f, 0.5f, 1.9f}, {1e-5f, 0, 0});
  const Bvh bvh(scene);
  const FloorPoints floor;
  const std::vector<uint8_t> keep = reached(bvh, floor.positions, floor.normals, Sides::Front, {});
  EXPECT_EQ(keep, std::vector<uint8_t>(keep.size(), 1));
}

TEST(Reach, LightGroupsMayNotCount) {
  scene::Scene scene = room_with_cupboard(0);
  add_point_light(&scene, {2.9f, 0.5f, 1.9f}, {9, 9, 9});
  const int lamp = scene.lights.back().light_group;
  const Bvh bvh(scene);
  const FloorPoints floor;
  const auto keep = [&](std::vector<int> without) {
    return reached(bvh, floor.positions, floor.normals, Sides::Front,
                   {.without = std::move(without)});
  };
  EXPECT_EQ(keep({lamp}), complement(floor.inside));
  EXPECT_EQ(keep({1 - lamp}), floor.inside);
}

TEST(Reach, ASurfaceLitFromBehindStaysAScenePointButNotAQueryPoint) {
  const scene::Scene scene = room_with_cupboard(0);
  const Bvh bvh(scene);
  // The outer wall's far side: its normal points out of the room, into the dark.
  const std::vector<Vec3> positions{{2, 0, 1}}, normals{{0, -1, 0}};
  EXPECT_EQ(reached(bvh, positions, normals, Sides::Front, {})[0], 0);
  EXPECT_EQ(reached(bvh, positions, normals, Sides::Either, {})[0], 1);
}

TEST(Reach, KeepsEverythingInTheDark) {
  scene::Scene scene = room_with_cupboard(0);
  for (scene::Material& material : scene.materials) material.emission = {};
  const Bvh bvh(scene);
  const FloorPoints floor;
  const std::vector<uint8_t> keep = reached(bvh, floor.positions, floor.normals, Sides::Front, {});
  EXPECT_EQ(keep, std::vector<uint8_t>(keep.size(), 1));
}

TEST(Reach, SamplesAreAsManyAsAskedForAndStandForTheReachedArea) {
  const scene::Scene scene = room_with_cupboard(0);
  const Bvh bvh(scene);
  PruneCounts counts;
  const scene::SurfaceSamples samples =
      sample_reached_surface(bvh, 500, {.seed = 4}, Purpose::Queries, {}, &counts);
  ASSERT_EQ(samples.size(), 500);
  EXPECT_GT(counts.pruned, 0);
  EXPECT_GE(counts.drawn, 500 + counts.pruned);
  double area = 0;
  for (const float a : samples.area) area += a;
  // 59 m² of room less 1 m² of floor, the lamp, and the five walls of the cupboard from outside.
  EXPECT_NEAR(area, 59 - 1 + 1 + 5, 1.5);
  for (const Vec3& p : samples.position) {
    const bool inside = p.x > 2.41f && p.x < 3.39f && p.z > 1.41f && p.z < 2.39f && p.y < 0.99f;
    EXPECT_FALSE(inside);
  }
}

/// Every pruned point of the room is black in a long run, too.
TEST(Reach, AgreesWithALongRun) {
  const scene::Scene scene = room_with_cupboard(0);
  const Bvh bvh(scene);
  const Lights lights(scene);
  const FloorPoints floor;
  const std::vector<uint8_t> keep = reached(bvh, floor.positions, floor.normals, Sides::Front, {});
  std::vector<Vec3> positions, normals;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) continue;
    positions.push_back(floor.positions[i]);
    normals.push_back(floor.normals[i]);
  }
  ASSERT_EQ(positions.size(), 25u);
  IrradianceOptions options;
  options.rays = 4096;
  const Irradiance e = estimate_irradiance(bvh, lights, positions, normals, options);
  for (int64_t i = 0; i < e.points; ++i) EXPECT_EQ(e.total(i), (Rgb{0, 0, 0})) << i;
}

TEST(Reach, DoesNotDependOnThreads) {
  const scene::Scene scene = room_with_cupboard(0.002f);
  const Bvh bvh(scene);
  const FloorPoints floor;
  set_num_threads(1);
  const std::vector<uint8_t> one = reached(bvh, floor.positions, floor.normals, Sides::Either, {});
  set_num_threads(3);
  EXPECT_EQ(one, reached(bvh, floor.positions, floor.normals, Sides::Either, {}));
  set_num_threads(0);
}

/// What is recalled of a scene before an object moved changes no point: not where that opens a
/// pocket, nor where it closes one.
TEST(Reach, RecalledDarknessGivesThePointsOfAWholeSearch) {
  scene::Scene scene = test::dark_room();
  test::add_lamp(&scene, {0.5f, 2.4f, 1}, 0.5f, 1, {8, 4, 2});
  const int gray = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({-0.2f, 0, -0.2f}, {0.2f, 0.4f, 0.2f}, gray, false),
                     test::translation({3.5f, 0, 1}));
  scene::SamplerOptions sampler;
  sampler.seed = 3;
  sampler.emissive_share = 0.1;
  ReachMemory memory;
  PruneCounts counts;
  {
    const Bvh bvh(scene);
    sample_reached_surface(bvh, 400, sampler, Purpose::Scene, {}, {nullptr, {}, &memory}, &counts);
  }
  const int64_t hidden = counts.pruned;
  ASSERT_GT(hidden, 50) << "the inner box is dark";
  // The small box, then the outer one away from the inner one, and back.
  const std::vector<std::pair<size_t, Vec3>> moves = {
      {4, {3.5f, 0, 2}}, {1, {0.9f, 0, 0.3f}}, {1, {0, 0, 0}}};
  for (const auto& [index, place] : moves) {
    const auto box = [&] {
      Bounds out;
      scene::Scene alone = scene;
      alone.instances = {scene.instances[index]};
      return alone.bounds();
    };
    std::vector<Bounds> changed = {box()};
    scene.instances[index].to_world = test::translation(place);
    changed.push_back(box());
    const Bvh bvh(scene);
    ReachMemory next;
    PruneCounts whole_counts;
    const scene::SurfaceSamples recalled = sample_reached_surface(
        bvh, 400, sampler, Purpose::Scene, {}, {&memory, changed, &next}, &counts);
    const scene::SurfaceSamples whole =
        sample_reached_surface(bvh, 400, sampler, Purpose::Scene, {}, &whole_counts);
    EXPECT_EQ(recalled.position, whole.position);
    EXPECT_EQ(recalled.area, whole.area);
    EXPECT_EQ(counts.pruned, whole_counts.pruned);
    memory = std::move(next);
  }
  EXPECT_EQ(counts.pruned, hidden) << "all is as it was";
}

/// A closed room with a box in it, a partition that leaves a passage, and a lamp; all surfaces but
/// the lamp wound as `windings` says, a bit a mesh.
scene::Scene wound_room(unsigned windings, bool double_sided, bool sky = false) {
  scene::Scene scene;
  scene.name = "wound";
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f}, {}, double_sided);
  const int light = add_material(&scene, {0.5f, 0.5f, 0.5f}, {9, 9, 9});
  add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  add_instance(&scene, test::box_mesh({0.5f, 0, 0.5f}, {1.3f, 1.1f, 1.4f}, white, false));
  add_instance(&scene, test::quad_mesh({2.5f, 0, 0}, {0, 0, 2}, {0, 2.5f, 0}, white));
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    if ((windings >> m & 1) == 0) continue;
    for (auto& triangle : scene.meshes[m].triangles) std::swap(triangle[1], triangle[2]);
  }
  add_quad(&scene, {1.5f, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, light);
  if (sky) test::add_sky(&scene, {3, 3, 3});
  return scene;
}

/// Where the room is, seen from a point of its walls or of the box; zero on the partition.
Vec3 into_the_room(const Vec3& p) {
  if (std::abs(p.x - 2.5f) < 1e-4f && p.z < 2) return {};
  const auto between = [](float value, float low, float high) {
    return value > low - 1e-4f && value < high + 1e-4f;
  };
  const bool box =
      between(p.x, 0.5f, 1.3f) && between(p.y, 0, 1.1f) && between(p.z, 0.5f, 1.4f) && p.y > 1e-4f;
  return box ? p - Vec3{0.9f, 0.55f, 0.95f} : Vec3{2, 1.25f, 1.5f} - p;
}

TEST(Reach, PointsFaceTheLightWhateverTheWinding) {
  for (const bool sky : {false, true}) {
    for (unsigned windings = 0; windings < 8; ++windings) {
      const scene::Scene scene = wound_room(windings, windings % 2 == 0, sky);
      const Bvh bvh(scene);
      scene::SamplerOptions sampler;
      sampler.seed = windings;
      sampler.emissive_share = 0.1;
      sampler.environment_share = 0.01;
      PruneCounts counts;
      int one_way = 0, other_way = 0;
      for (const Purpose purpose : {Purpose::Scene, Purpose::Queries}) {
        const scene::SurfaceSamples points =
            sample_reached_surface(bvh, 600, sampler, purpose, {.seed = windings}, &counts);
        for (size_t i = 0; i < points.position.size(); ++i) {
          const Vec3& p = points.position[i];
          const bool under = p.y < 1e-4f && p.x > 0.5f && p.x < 1.3f && p.z > 0.5f && p.z < 1.4f;
          if (max_component(points.emission[i]) > 0 || under) continue;
          const Vec3 inwards = into_the_room(points.position[i]);
          if (dot(inwards, inwards) == 0) {
            ++(points.normal[i].x > 0 ? one_way : other_way);
          } else {
            EXPECT_GT(dot(points.normal[i], inwards), 0)
                << "windings " << windings << ", sky " << sky << ", point " << i;
          }
        }
      }
      // Both sides of the partition are in the room.
      EXPECT_NEAR(one_way, other_way, 5 * std::sqrt(one_way + other_way)) << windings;
      EXPECT_GT(one_way, 10);
    }
  }
}

TEST(Reach, FacesOfLampsThatShineAtNothingHaveNoPoints) {
  // A globe that emits from both sides: what leaves it is its outside's.
  scene::Scene scene;
  const int white = add_material(&scene, {0.7f, 0.7f, 0.7f});
  const int glow = add_material(&scene, {0.5f, 0.5f, 0.5f}, {2, 3, 4}, /*double_sided=*/true);
  add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  add_instance(&scene, test::inward_sphere_mesh(0.3f, 3, glow), test::translation({2, 1.2f, 1.5f}));
  const Bvh bvh(scene);
  scene::SamplerOptions sampler;
  sampler.emissive_share = 0.1;
  PruneCounts counts;
  const scene::SurfaceSamples points =
      sample_reached_surface(bvh, 1000, sampler, Purpose::Scene, {}, &counts);
  ASSERT_EQ(points.size(), 1000);
  double area = 0;
  for (size_t i = 0; i < points.position.size(); ++i) {
    if (points.light_group[i] == scene::kNone) continue;
    area += points.area[i];
    EXPECT_GT(dot(points.normal[i], points.position[i] - Vec3{2, 1.2f, 1.5f}), 0);
  }
  EXPECT_NEAR(area, 4 * kPi * 0.3 * 0.3, 0.06);
  // A room whose walls are all that emits keeps its light.
  scene::Scene furnace;
  const int wall = add_material(&furnace, {0.5f, 0.5f, 0.5f}, {1, 1, 1}, /*double_sided=*/true);
  add_instance(&furnace, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, wall, true));
  const Bvh walls(furnace);
  const scene::SurfaceSamples all =
      sample_reached_surface(walls, 500, sampler, Purpose::Scene, {}, &counts);
  EXPECT_EQ(all.size(), 500);
}

TEST(Reach, AllOfASurfaceIsTurnedToTheLightAndLampsAreNot) {
  scene::Scene scene = wound_room(5, true);
  add_point_light(&scene, {2, 1, 2.8f}, {1, 1, 1});
  const Bvh bvh(scene);
  scene::SamplerOptions sampler;
  sampler.emissive_share = 0.1;
  const scene::SurfaceSamples turned = sample_turned_surface(bvh, 400, sampler, {});
  const scene::SurfaceSamples plain = scene::sample_surface(scene, 400, sampler);
  EXPECT_EQ(turned.position, plain.position);
  EXPECT_EQ(turned.area, plain.area);
  int flipped = 0;
  for (size_t i = 0; i < turned.position.size(); ++i) {
    const bool same = turned.normal[i] == plain.normal[i];
    EXPECT_TRUE(same || turned.normal[i] == -plain.normal[i]);
    EXPECT_TRUE(same || max_component(plain.emission[i]) == 0);
    flipped += same ? 0 : 1;
  }
  EXPECT_GT(flipped, 200) << "the walls were wound outwards";
}

}  // namespace
}  // namespace lte::pathtrace
