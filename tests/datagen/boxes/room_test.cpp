#include "datagen/boxes/room.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "datagen/boxes/furniture.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/sampler.h"

namespace lte::datagen::boxes {
namespace {

constexpr uint64_t kRooms = 60;

RoomConfig config() {
  RoomConfig rooms;
  rooms.texture_sizes = {8};  // what the tests look at does not depend on it
  return rooms;
}

/// Lengths of the overlap of two boxes along each axis; not positive where they are apart.
Vec3 overlap(const Bounds& a, const Bounds& b) { return min(a.high, b.high) - max(a.low, b.low); }

bool apart(const Bounds& a, const Bounds& b, float tolerance = 1e-5f) {
  const Vec3 common = overlap(a, b);
  return std::min({common.x, common.y, common.z}) <= tolerance;
}

/// World bounds of the instances whose mesh has this name.
Bounds bounds_of(const scene::Scene& scene, const std::string& name) {
  Bounds bounds;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    if (mesh.name != name) continue;
    for (const Vec3& p : mesh.positions) bounds.extend(instance.to_world.point(p));
  }
  return bounds;
}

TEST(BoxRoom, SameSeedGivesTheSameScene) {
  const Room a = generate_room(config(), 7), b = generate_room(config(), 7),
             c = generate_room(config(), 8);
  ASSERT_EQ(a.scene.meshes.size(), b.scene.meshes.size());
  for (size_t i = 0; i < a.scene.meshes.size(); ++i) {
    EXPECT_EQ(a.scene.meshes[i].positions, b.scene.meshes[i].positions);
    EXPECT_EQ(a.scene.meshes[i].triangles, b.scene.meshes[i].triangles);
  }
  ASSERT_EQ(a.scene.materials.size(), b.scene.materials.size());
  for (size_t i = 0; i < a.scene.materials.size(); ++i) {
    EXPECT_EQ(a.scene.materials[i].base_color, b.scene.materials[i].base_color);
    EXPECT_EQ(a.scene.materials[i].emission, b.scene.materials[i].emission);
  }
  EXPECT_NE(a.scene.bounds().high, c.scene.bounds().high);
}

TEST(BoxRoom, HasTheConfiguredSize) {
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const Room room = generate_room(config(), seed);
    for (const Bounds& inner : room.plan.rooms) {
      const Vec3 size = inner.extent();
      EXPECT_GE(size.x, 2.5f - 1e-4f);
      EXPECT_LE(size.x, 7.0f + 1e-4f);
      EXPECT_GE(size.y, 2.3f);
      EXPECT_LE(size.y, 3.2f);
      EXPECT_GE(size.z, 2.5f);
      EXPECT_LE(size.z, 7.0f);
      EXPECT_EQ(inner.low.y, 0.0f);
    }
    Bounds all;
    for (const Bounds& inner : room.plan.rooms) {
      all.extend(inner.low);
      all.extend(inner.high);
    }
    EXPECT_EQ(room.scene.bounds().low, all.low) << "something pokes through a wall, seed " << seed;
    EXPECT_EQ(room.scene.bounds().high, all.high)
        << "something pokes through a wall, seed " << seed;
  }
}

TEST(BoxRoom, LightsAreFlushClearOfWallsAndOfTallThings) {
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const RoomPlan plan = generate_room(config(), seed).plan;
    ASSERT_GE(plan.lights.size(), 1u);
    ASSERT_LE(plan.lights.size(), 3u);
    for (const Bounds& light : plan.lights) {
      int rooms = 0;
      for (const Bounds& inner : plan.rooms) {
        const bool inside = light.low.x >= inner.low.x + 0.4f - 1e-4f &&
                            light.high.x <= inner.high.x - 0.4f + 1e-4f &&
                            light.low.z >= inner.low.z + 0.4f - 1e-4f &&
                            light.high.z <= inner.high.z - 0.4f + 1e-4f;
        rooms += inside;
        EXPECT_EQ(light.high.y, inner.high.y);
      }
      EXPECT_EQ(rooms, 1) << "a light nearer than 0.4 m to a wall, seed " << seed;
      EXPECT_LE(light.extent().y, 0.021f);
      for (const PlacedPiece& piece : plan.furniture) {
        if (piece.bounds.high.y <= light.high.y - 0.7f) continue;
        const float dx =
            std::max(piece.bounds.low.x - light.high.x, light.low.x - piece.bounds.high.x);
        const float dz =
            std::max(piece.bounds.low.z - light.high.z, light.low.z - piece.bounds.high.z);
        EXPECT_GE(std::max(dx, dz), 0.3f - 1e-4f) << piece.name << " under a light, seed " << seed;
      }
    }
  }
}

TEST(BoxRoom, FurnitureIsInsideOnTheFloorAndApart) {
  size_t pieces = 0;
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const Room room = generate_room(config(), seed);
    const auto& furniture = room.plan.furniture;
    pieces += furniture.size();
    for (size_t i = 0; i < furniture.size(); ++i) {
      const Bounds& bounds = furniture[i].bounds;
      const Bounds& inner = room.plan.rooms[static_cast<size_t>(furniture[i].room)];
      const bool picture = furniture[i].name.ends_with("picture");
      const Bounds drawn = bounds_of(room.scene, furniture[i].name);
      ASSERT_FALSE(drawn.empty()) << furniture[i].name;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(bounds.low[axis], inner.low[axis]) << furniture[i].name << ", seed " << seed;
        EXPECT_LE(bounds.high[axis], inner.high[axis]) << furniture[i].name << ", seed " << seed;
        EXPECT_GE(drawn.low[axis], bounds.low[axis] - 1e-4f) << furniture[i].name;
        EXPECT_LE(drawn.high[axis], bounds.high[axis] + 1e-4f) << furniture[i].name;
      }
      EXPECT_EQ(bounds.low.y == 0, !picture) << furniture[i].name;
      for (size_t j = 0; j < i; ++j)
        EXPECT_TRUE(apart(bounds, furniture[j].bounds, 0))
            << furniture[i].name << " and " << furniture[j].name << ", seed " << seed;
    }
  }
  EXPECT_GT(pieces, 4 * kRooms) << "rooms are all but empty";
}

TEST(BoxRoom, TwoRoomScenesHaveTheirShareAndAFreeDoorway) {
  int two = 0;
  constexpr int kScenes = 300;
  for (uint64_t seed = 0; seed < kScenes; ++seed) {
    const Room room = generate_room(config(), seed);
    if (room.plan.rooms.size() < 2) continue;
    ++two;
    const Vec3 size = room.plan.doorway.extent();
    EXPECT_GE(size.z, 0.8f - 1e-4f);
    EXPECT_LE(size.z, 1.2f + 1e-4f);
    EXPECT_GE(size.y, 2.0f);
    EXPECT_LE(size.y, 2.1f);
    const pathtrace::Bvh bvh(room.scene);
    Vec3 from = room.plan.doorway.center();
    from.x = room.plan.doorway.low.x - 0.7f;
    EXPECT_FALSE(bvh.occluded({from, {1, 0, 0}, 0, size.x + 1.4f})) << "seed " << seed;
    from.z = room.plan.doorway.low.z - 0.05f;  // beside it there is wall
    EXPECT_TRUE(bvh.occluded({from, {1, 0, 0}, 0, size.x + 1.4f})) << "seed " << seed;
  }
  EXPECT_NEAR(two, 0.25 * kScenes, 4 * std::sqrt(kScenes * 0.25 * 0.75));
}

TEST(BoxRoom, EveryRayFromFreeSpaceMeetsAFront) {
  int64_t rays = 0, backs = 0;
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const Room room = generate_room(config(), seed);
    const pathtrace::Bvh bvh(room.scene);
    Rng rng(seed, 99);
    for (int i = 0; i < 4000; ++i) {
      const Bounds& inner = room.plan.rooms[rng.below(room.plan.rooms.size())];
      Vec3 at;
      for (int axis = 0; axis < 3; ++axis)
        at[axis] = rng.uniform(inner.low[axis] + 0.01f, inner.high[axis] - 0.05f);
      bool inside = false;
      for (const PlacedPiece& piece : room.plan.furniture)
        inside |= !apart({at, at + Vec3{1e-3f, 1e-3f, 1e-3f}}, piece.bounds);
      if (inside) continue;
      const float y = rng.uniform(-1, 1), phi = rng.uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
      const Vec3 direction{r * std::cos(phi), y, r * std::sin(phi)};
      const pathtrace::Hit hit = bvh.intersect({at, direction});
      ASSERT_TRUE(hit.valid()) << "light leaks out, seed " << seed;
      ++rays;
      backs += dot(hit.normal, direction) >= 0;
    }
  }
  EXPECT_GT(rays, 100'000);
  EXPECT_LE(backs, rays / 50'000) << "something is open or inside out";
}

TEST(BoxRoom, OpenRoomsLackTheOneWallThatThePlanNames) {
  RoomConfig rooms = config();
  rooms.open_share = 0.5;
  int open = 0;
  constexpr int kScenes = 200;
  for (uint64_t seed = 0; seed < kScenes; ++seed) {
    const Room room = generate_room(rooms, seed);
    ASSERT_EQ(room.plan.missing_walls.size(), room.plan.rooms.size());
    open += room.plan.missing_walls[0] != 0;
    const pathtrace::Bvh bvh(room.scene);
    for (size_t r = 0; r < room.plan.rooms.size(); ++r) {
      const Bounds& inner = room.plan.rooms[r];
      for (const int axis : {0, 2}) {
        for (const bool high : {false, true}) {
          Vec3 from = inner.center(), out;
          from.y = inner.high.y - 0.05f;  // above pictures and the doorway
          from[axis] = high ? inner.high[axis] - 0.01f : inner.low[axis] + 0.01f;
          out[axis] = high ? 1.0f : -1.0f;
          const unsigned face = 1u << (2 * axis + (high ? 1 : 0));
          const float far = high == (r == 0) || axis == 2 ? 100.0f : 0.02f;  // not the other room
          EXPECT_EQ(bvh.occluded({from, out, 0, far}), face != room.plan.missing_walls[r])
              << "seed " << seed << ", room " << r << ", face " << face;
        }
      }
    }
  }
  EXPECT_NEAR(open, 0.5 * kScenes, 4 * std::sqrt(kScenes * 0.25));
}

TEST(BoxRoom, SkyAndSunShineInThroughTheOpenSide) {
  RoomConfig rooms = config(), dark = rooms;
  rooms.open_share = dark.open_share = 0.5;
  rooms.sky_share = 1;
  int skies = 0, suns = 0, lamps = 0;
  constexpr int kScenes = 200;
  for (uint64_t seed = 0; seed < kScenes; ++seed) {
    const Room room = generate_room(rooms, seed), before = generate_room(dark, seed);
    EXPECT_FALSE(before.scene.environment);
    EXPECT_EQ(room.plan.rooms[0].high, before.plan.rooms[0].high) << "the same room under the sky";
    EXPECT_EQ(room.plan.missing_walls, before.plan.missing_walls);
    const bool open = room.plan.missing_walls[0] != 0;
    ASSERT_EQ(room.scene.environment.has_value(), open) << "seed " << seed;
    EXPECT_EQ(room.scene.light_groups.size(),
              room.plan.lights.size() + room.scene.lights.size() + (open ? 1 : 0));
    if (!open) continue;
    ++skies;
    lamps += !room.plan.lights.empty();
    if (room.scene.lights.empty()) continue;
    ++suns;
    const scene::PunctualLight& sun = room.scene.lights[0];
    ASSERT_EQ(sun.kind, scene::LightKind::Directional);
    const double ratio =
        luminance(sun.intensity) / (M_PI * luminance(room.scene.environment->radiance));
    EXPECT_GE(ratio, 0.999);
    EXPECT_LE(ratio, 6.001);
    const unsigned side = room.plan.missing_walls[0];
    const int axis = side == kNegX || side == kPosX ? 0 : 2;
    const bool high = side == kPosX || side == kPosZ;
    EXPECT_GT((high ? -1 : 1) * sun.direction[axis], 0.25f) << "it shines in, seed " << seed;
    const pathtrace::Bvh bvh(room.scene);
    Vec3 from = room.plan.rooms[0].center();
    from[axis] = high ? room.plan.rooms[0].high[axis] : room.plan.rooms[0].low[axis];
    EXPECT_FALSE(bvh.occluded({from, -sun.direction})) << "seed " << seed;
  }
  for (const int half : {suns, lamps}) EXPECT_NEAR(half, 0.5 * skies, 4 * std::sqrt(skies * 0.25));
  EXPECT_GT(skies, kScenes / 4);
}

TEST(BoxRoom, NoneOfASkyOutsideComesIntoAShutRoom) {
  RoomConfig rooms = config(), dark = rooms;
  rooms.open_share = dark.open_share = 0.5;
  rooms.shut_sky_share = 1;
  int shut = 0, suns = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    const Room room = generate_room(rooms, seed), before = generate_room(dark, seed);
    EXPECT_EQ(room.plan.rooms[0].high, before.plan.rooms[0].high) << "the same room under the sky";
    EXPECT_EQ(room.plan.lights.size(), before.plan.lights.size()) << "its lamps stay";
    ASSERT_EQ(room.scene.environment.has_value(), room.plan.missing_walls[0] == 0) << seed;
    if (!room.scene.environment) continue;
    ++shut;
    suns += !room.scene.lights.empty();
    const pathtrace::Bvh bvh(room.scene);
    Rng rng(seed, 1);
    for (const Bounds& inner : room.plan.rooms) {
      for (int i = 0; i < 200; ++i) {
        const Vec3 to = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
        EXPECT_TRUE(bvh.occluded({inner.center(), normalize(to)})) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(shut, 15);
  EXPECT_GT(suns, 0);
  EXPECT_LT(suns, shut);
}

TEST(BoxRoom, PicturesHangOnWallsThatAreThere) {
  RoomConfig rooms = config();
  rooms.open_share = 1;
  int64_t pictures = 0;
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const RoomPlan plan = generate_room(rooms, seed).plan;
    for (const PlacedPiece& piece : plan.furniture) {
      if (!piece.name.ends_with("picture")) continue;
      ++pictures;
      const auto r = static_cast<size_t>(piece.room);
      const Bounds& inner = plan.rooms[r];
      for (const int axis : {0, 2}) {
        const unsigned low = 1u << (2 * axis), high = low << 1;
        EXPECT_FALSE(plan.missing_walls[r] == low && piece.bounds.low[axis] == inner.low[axis]);
        EXPECT_FALSE(plan.missing_walls[r] == high && piece.bounds.high[axis] == inner.high[axis]);
      }
    }
  }
  EXPECT_GT(pictures, static_cast<int64_t>(kRooms) / 2);
}

TEST(BoxRoom, SizeFactorEnlargesEverythingButTheLight) {
  RoomConfig large = config();
  large.size_factor = {2, 2};
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Room a = generate_room(config(), seed), b = generate_room(large, seed);
    EXPECT_EQ(b.scene.bounds().high, a.scene.bounds().high * 2);
    EXPECT_NEAR(scene::surface_area(b.scene), 4 * scene::surface_area(a.scene),
                1e-4 * scene::surface_area(b.scene));
    ASSERT_EQ(a.plan.furniture.size(), b.plan.furniture.size());
    for (size_t i = 0; i < a.plan.furniture.size(); ++i)
      EXPECT_EQ(b.plan.furniture[i].bounds.high, a.plan.furniture[i].bounds.high * 2);
    ASSERT_EQ(a.scene.materials.size(), b.scene.materials.size());
    for (size_t i = 0; i < a.scene.materials.size(); ++i)
      EXPECT_EQ(a.scene.materials[i].emission, b.scene.materials[i].emission);
  }
  large.size_factor = {0.5, 4};  // a factor of its own for each scene
  const Room one = generate_room(large, 1), two = generate_room(large, 2);
  const float first = one.scene.bounds().high.y, second = two.scene.bounds().high.y;
  for (const float height : {first, second}) {
    EXPECT_GE(height, 0.5f * 2.3f);
    EXPECT_LE(height, 4 * 3.2f);
  }
  EXPECT_NE(first / generate_room(config(), 1).scene.bounds().high.y,
            second / generate_room(config(), 2).scene.bounds().high.y);
}

TEST(BoxRoom, LightGroupsAndRadianceAreAsConfigured) {
  for (uint64_t seed = 0; seed < kRooms; ++seed) {
    const Room room = generate_room(config(), seed);
    ASSERT_EQ(room.scene.light_groups.size(), room.plan.lights.size());
    std::vector<int> found(room.plan.lights.size(), 0);
    for (const scene::Instance& instance : room.scene.instances) {
      const scene::Mesh& mesh = room.scene.meshes[static_cast<size_t>(instance.mesh)];
      const scene::Material& material = room.scene.materials[static_cast<size_t>(mesh.material)];
      EXPECT_EQ(material.emissive(), instance.light_group != scene::kNone);
      if (!material.emissive()) continue;
      ++found[static_cast<size_t>(instance.light_group)];
      EXPECT_GE(luminance(material.emission), 2.0f - 1e-3f);
      EXPECT_LE(luminance(material.emission), 40.0f + 1e-2f);
      EXPECT_FALSE(material.double_sided);
    }
    for (const int instances : found) EXPECT_EQ(instances, 1);
  }
}

TEST(BoxRoom, AlbedosAreThoseOfRealSurfaces) {
  double sum = 0;
  int64_t count = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Room room = generate_room(config(), seed);
    const scene::SurfaceSamples points = scene::sample_surface(room.scene, 1000, {});
    for (const Rgb& albedo : points.albedo) {
      EXPECT_GE(std::min({albedo.x, albedo.y, albedo.z}), 0.005f);
      EXPECT_LE(max_component(albedo), 0.96f);
      sum += luminance(albedo);
      ++count;
    }
  }
  EXPECT_NEAR(sum / static_cast<double>(count), 0.5, 0.12);
}

TEST(BoxRoom, ALightThatFitsNowhereIsAnError) {
  RoomConfig rooms = config();
  rooms.width_m = rooms.depth_m = {0.9, 0.95};
  rooms.two_room_share = 0;
  EXPECT_THROW(generate_room(rooms, 1), Error);
}

/// The rectangles of a piece's upright and level faces: plane axis and position, extent in the
/// other two axes.
struct Face {
  int axis;
  float at;
  Bounds box;
};

std::vector<Face> faces_of(const Assembly& piece) {
  std::vector<Face> faces;
  for (const Part& part : piece.parts) {
    for (int axis = 0; axis < 3; ++axis) {
      if (part.segments > 0 && axis != 1) continue;
      for (int side = 0; side < 2; ++side) {
        if (!(part.faces & (1u << (2 * axis + side)))) continue;
        faces.push_back({axis, side ? part.high[axis] : part.low[axis], {part.low, part.high}});
      }
    }
  }
  return faces;
}

TEST(Furniture, PartsDoNotOverlapAndFacesDoNotCoincide) {
  for (int kind = 0; kind < kPieceKinds; ++kind) {
    for (uint64_t seed = 0; seed < 40; ++seed) {
      scene::Scene scene;
      MaterialFactory materials(&scene, {8}, seed);
      Rng rng(seed);
      const Assembly piece = make_piece(static_cast<PieceKind>(kind), 2.4f, &materials, &rng);
      ASSERT_FALSE(piece.parts.empty());
      EXPECT_EQ(piece.bounds().low.y, 0.0f) << piece.name;
      EXPECT_LE(piece.bounds().high.y, 2.4f) << piece.name;
      for (size_t i = 0; i < piece.parts.size(); ++i) {
        const Part& a = piece.parts[i];
        for (int axis = 0; axis < 3; ++axis) EXPECT_LT(a.low[axis], a.high[axis]) << piece.name;
        for (size_t j = 0; j < i; ++j)
          EXPECT_TRUE(apart({a.low, a.high}, {piece.parts[j].low, piece.parts[j].high}))
              << piece.name << " parts " << i << ", " << j << ", seed " << seed;
      }
      const std::vector<Face> faces = faces_of(piece);
      for (size_t i = 0; i < faces.size(); ++i) {
        for (size_t j = 0; j < i; ++j) {
          if (faces[i].axis != faces[j].axis || std::abs(faces[i].at - faces[j].at) > 1e-6f)
            continue;
          const Vec3 common = overlap(faces[i].box, faces[j].box);
          const int u = (faces[i].axis + 1) % 3, v = (faces[i].axis + 2) % 3;
          EXPECT_LE(std::min(common[u], common[v]), 1e-5f) << piece.name << ", seed " << seed;
        }
      }
    }
  }
}

TEST(Parts, PlacementTurnsZTowardsXAndQuarterTurnsAreExact) {
  const Affine quarter = placement(90, {1, 2, 3});
  EXPECT_EQ(quarter.point({0, 0, 1}), (Vec3{2, 2, 3}));
  EXPECT_EQ(quarter.point({1, 0, 0}), (Vec3{1, 2, 2}));
  const Affine turned = placement(30, {});
  EXPECT_NEAR(turned.determinant(), 1, 1e-6);
  EXPECT_NEAR(turned.point({0, 0, 1}).x, 0.5, 1e-6);
}

TEST(Parts, MeshesHaveTheAreaAndTheNormalsOfTheirPart) {
  for (const bool inward : {false, true}) {
    for (const int segments : {0, 64}) {
      scene::Scene scene;
      scene.materials.emplace_back();
      const Part part{{1, 2, 3}, {2, 4, 4}, 0, kAllFaces, segments, inward};
      scene.instances.push_back({add_meshes(&scene, "part", {part})[0], {}, scene::kNone});
      const double exact =
          segments ? 2 * M_PI * 0.25 + M_PI * 2 : 10;  // radius 0.5 and height 2; 1 x 2 x 1
      EXPECT_NEAR(scene::surface_area(scene), exact, segments ? 0.01 * exact : 1e-5);
      const scene::Mesh& mesh = scene.meshes[0];
      const Vec3 centre{1.5f, 3, 3.5f};
      for (const auto& t : mesh.triangles) {
        const Vec3 p = mesh.positions[t[0]], q = mesh.positions[t[1]], r = mesh.positions[t[2]];
        const float outward = dot(cross(q - p, r - p), (p + q + r) / 3 - centre);
        EXPECT_GT(inward ? -outward : outward, 0);
      }
    }
  }
}

}  // namespace
}  // namespace lte::datagen::boxes
