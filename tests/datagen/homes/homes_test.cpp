#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "datagen/homes/floor_plan.h"
#include "datagen/homes/home.h"
#include "lte/base/check.h"
#include "lte/pathtrace/bvh.h"
#include "tests/datagen/homes/coarse.h"

namespace lte::datagen::homes {
namespace {

constexpr uint64_t kHomes = 12;

/// Two homes of each number of rooms, made once.
const std::vector<Home>& all_homes() {
  static const std::vector<Home> homes = [] {
    std::vector<Home> made;
    for (uint64_t seed = 0; seed < kHomes; ++seed) {
      HomeConfig config = coarse();
      config.rooms = {static_cast<int64_t>(seed % 6) + 1, static_cast<int64_t>(seed % 6) + 1};
      made.push_back(generate_home(config, seed));
    }
    return made;
  }();
  return homes;
}

/// Corners of a turned box, seen from above.
std::array<Vec2, 4> corners(const OrientedBox& b) {
  std::array<Vec2, 4> out;
  for (size_t i = 0; i < 4; ++i) {
    const float u = i == 0 || i == 3 ? -b.half.x : b.half.x, v = i < 2 ? -b.half.y : b.half.y;
    out[i] = {b.centre.x + u * b.axis.x - v * b.axis.y, b.centre.y + u * b.axis.y + v * b.axis.x};
  }
  return out;
}

/// Area of the intersection of two turned boxes, by clipping one at the edges of the other
/// (Sutherland-Hodgman): shares no code with the separating axes of the generator.
double common_area(const OrientedBox& a, const OrientedBox& b) {
  const auto first = corners(a), second = corners(b);
  std::vector<Vec2> polygon(first.begin(), first.end());
  for (size_t e = 0; e < 4 && !polygon.empty(); ++e) {
    const Vec2 p = second[e], q = second[(e + 1) % 4];
    const auto side = [&](const Vec2& x) {
      return (q.x - p.x) * (x.y - p.y) - (q.y - p.y) * (x.x - p.x);
    };
    std::vector<Vec2> kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 from = polygon[i], to = polygon[(i + 1) % polygon.size()];
      const float s = side(from), t = side(to);
      if (s >= 0) kept.push_back(from);
      if ((s < 0) != (t < 0))
        kept.push_back(
            {from.x + (to.x - from.x) * s / (s - t), from.y + (to.y - from.y) * s / (s - t)});
    }
    polygon = kept;
  }
  double area = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (p.x * q.y - p.y * q.x);
  }
  return std::abs(area);
}

double common_volume(const OrientedBox& a, const OrientedBox& b) {
  const double high = std::min(a.high, b.high) - std::max(a.low, b.low);
  return high <= 0 ? 0 : high * common_area(a, b);
}

OrientedBox upright(const Bounds& b) {
  const Vec3 c = b.center(), h = b.extent() * 0.5f;
  return {{c.x, c.z}, {h.x, h.z}, {1, 0}, b.low.y, b.high.y};
}

/// The room in front of an opening, `deep` metres into `room`.
Bounds before(const FloorPlan& plan, const Opening& o, float deep, float low, float high) {
  const Rect& r = plan.rooms[static_cast<size_t>(o.room)].inner;
  switch (o.side) {
    case Side::NegX:
      return {{r.x0, low, o.from}, {r.x0 + deep, high, o.to}};
    case Side::PosX:
      return {{r.x1 - deep, low, o.from}, {r.x1, high, o.to}};
    case Side::NegZ:
      return {{o.from, low, r.z0}, {o.to, high, r.z0 + deep}};
    default:
      return {{o.from, low, r.z1 - deep}, {o.to, high, r.z1}};
  }
}

TEST(Homes, SameSeedGivesTheSameSceneToTheBit) {
  const Home a = generate_home(coarse(), 7), b = generate_home(coarse(), 7),
             c = generate_home(coarse(), 8);
  ASSERT_EQ(a.scene.meshes.size(), b.scene.meshes.size());
  for (size_t i = 0; i < a.scene.meshes.size(); ++i) {
    EXPECT_EQ(a.scene.meshes[i].positions, b.scene.meshes[i].positions);
    EXPECT_EQ(a.scene.meshes[i].triangles, b.scene.meshes[i].triangles);
  }
  ASSERT_EQ(a.scene.textures.size(), b.scene.textures.size());
  for (size_t i = 0; i < a.scene.textures.size(); ++i)
    EXPECT_EQ(a.scene.textures[i]->texels(), b.scene.textures[i]->texels());
  ASSERT_EQ(a.scene.instances.size(), b.scene.instances.size());
  for (size_t i = 0; i < a.scene.instances.size(); ++i)
    EXPECT_EQ(a.scene.instances[i].to_world.m, b.scene.instances[i].to_world.m);
  EXPECT_NE(a.scene.bounds().high, c.scene.bounds().high);
}

TEST(Homes, PlansHaveTheRoomsAskedForApartAndWithinTheExtent) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Rng rng(seed);
    const int rooms = static_cast<int>(seed % 6) + 1;
    const FloorPlan plan = make_floor_plan(rooms, 2.6f, &rng);
    ASSERT_EQ(plan.rooms.size(), static_cast<size_t>(rooms));
    int corridors = 0;
    for (size_t i = 0; i < plan.rooms.size(); ++i) {
      const Rect& a = plan.rooms[i].inner;
      corridors += plan.rooms[i].type == RoomType::Corridor;
      EXPECT_GE(std::min(a.width(), a.depth()), 1.1f) << seed;
      EXPECT_GE(std::min(a.x0, a.z0), 0) << seed;
      EXPECT_LE(std::max(a.x1, a.z1), kMaxHomeExtent) << seed;
      for (size_t j = 0; j < i; ++j) {
        const Rect& b = plan.rooms[j].inner;
        const float gap =
            std::max(std::max(a.x0 - b.x1, b.x0 - a.x1), std::max(a.z0 - b.z1, b.z0 - a.z1));
        EXPECT_GE(gap, plan.wall - 1e-3f) << "walls have thickness, seed " << seed;
      }
    }
    EXPECT_EQ(corridors, rooms >= 4 ? 1 : 0) << seed;
    for (const Opening& o : plan.openings) {
      EXPECT_GT(o.to - o.from, 0.45f);
      EXPECT_LT(o.top, plan.height);
      for (const Opening& other : plan.openings_of(o.room))
        if (other.side == o.side && other.from != o.from) {
          EXPECT_TRUE(other.to <= o.from || o.to <= other.from)
              << "two holes in one place, seed " << seed;
        }
    }
  }
}

/// A grid over the whole home, flooded from the entrance: cells in a room or in a doorway whose
/// surroundings hold nothing between ankle and head.
TEST(Homes, EveryRoomCanBeWalkedToFromTheEntrance) {
  constexpr float kCell = 0.05f, kRadius = 0.2f;
  for (const Home& home : all_homes()) {
    const FloorPlan& plan = home.plan.floor;
    Bounds all;
    for (const PlanRoom& r : plan.rooms) {
      all.extend({r.inner.x0, 0, r.inner.z0});
      all.extend({r.inner.x1, 0, r.inner.z1});
    }
    const int w = static_cast<int>(all.extent().x / kCell),
              h = static_cast<int>(all.extent().z / kCell);
    const auto middle = [&](int x, int z) {
      return Vec2{all.low.x + kCell * (static_cast<float>(x) + 0.5f),
                  all.low.z + kCell * (static_cast<float>(z) + 0.5f)};
    };
    std::vector<int> state(static_cast<size_t>(w * h), -1);  // −1: wall, −2: blocked, else the room
    for (int z = 0; z < h; ++z) {
      for (int x = 0; x < w; ++x) {
        const Vec2 p = middle(x, z);
        int& cell = state[static_cast<size_t>(z * w + x)];
        for (size_t r = 0; r < plan.rooms.size(); ++r) {
          const Rect& q = plan.rooms[r].inner;
          if (p.x > q.x0 + kRadius && p.x < q.x1 - kRadius && p.y > q.z0 + kRadius &&
              p.y < q.z1 - kRadius)
            cell = static_cast<int>(r);
        }
        for (const Opening& o : plan.openings) {
          if (o.kind != OpeningKind::Doorway) continue;
          Bounds hole = before(plan, o, 0.3f, 0, 2);  // the passage, and a step on both sides
          const bool z_wall = o.side == Side::NegX || o.side == Side::PosX;
          (z_wall ? hole.high.x : hole.high.z) += o.depth + 0.3f;
          const float across = z_wall ? p.y : p.x, slack = kRadius;
          if (p.x > hole.low.x && p.x < hole.high.x && p.y > hole.low.z && p.y < hole.high.z &&
              across > o.from + slack && across < o.to - slack && cell == -1)
            cell = static_cast<int>(plan.rooms.size());
        }
        if (cell < 0) continue;
        const OrientedBox person{p, {0.7f * kRadius, 0.7f * kRadius}, {1, 0}, 0.05f, 1.8f};
        for (const PlacedPiece& piece : home.plan.pieces)
          if (common_volume(person, piece.box) > 0) cell = -2;
      }
    }
    const auto entrance =
        std::find_if(plan.openings.begin(), plan.openings.end(),
                     [](const Opening& o) { return o.kind == OpeningKind::Entrance; });
    ASSERT_NE(entrance, plan.openings.end());
    const Vec3 start = before(plan, *entrance, 0.7f, 0, 1).center();
    const int sx = static_cast<int>((start.x - all.low.x) / kCell),
              sz = static_cast<int>((start.z - all.low.z) / kCell);
    ASSERT_GE(state[static_cast<size_t>(sz * w + sx)], 0) << "the entrance is blocked";
    std::vector<int> queue{sz * w + sx};
    std::vector<char> seen(state.size(), 0);
    seen[static_cast<size_t>(queue[0])] = 1;
    std::map<int, int> cells;
    for (size_t i = 0; i < queue.size(); ++i) {
      const int x = queue[i] % w, z = queue[i] / w;
      ++cells[state[static_cast<size_t>(queue[i])]];
      for (const auto& [dx, dz] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int nx = x + dx, nz = z + dz;
        if (nx < 0 || nz < 0 || nx >= w || nz >= h) continue;
        const auto next = static_cast<size_t>(nz * w + nx);
        if (seen[next] || state[next] < 0) continue;
        seen[next] = 1;
        queue.push_back(static_cast<int>(next));
      }
    }
    for (size_t r = 0; r < plan.rooms.size(); ++r)
      EXPECT_GT(cells[static_cast<int>(r)], 100)
          << room_name(plan.rooms[r].type) << " " << r << " of " << plan.rooms.size();
  }
}

TEST(Homes, NothingInterpenetrates) {
  size_t pairs = 0;
  for (uint64_t seed = 0; seed < kHomes; ++seed) {
    const auto& pieces = all_homes()[seed].plan.pieces;
    for (size_t i = 0; i < pieces.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (common_volume(pieces[i].box, pieces[j].box) < 1e-7) continue;
        ++pairs;  // a chair under its table, say: their parts are apart
        for (const OrientedBox& a : pieces[i].solids)
          for (const OrientedBox& b : pieces[j].solids)
            ASSERT_LT(common_volume(a, b), 1e-7)
                << pieces[i].name << " and " << pieces[j].name << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(pairs, 10u) << "the parts were not tried";
}

TEST(Homes, PiecesAreInTheirRoomsAndAsManyAsAHomeHas) {
  for (uint64_t seed = 0; seed < kHomes; ++seed) {
    const Home& home = all_homes()[seed];
    EXPECT_GE(home.plan.pieces.size(), 5 * home.plan.floor.rooms.size()) << seed;
    for (const PlacedPiece& piece : home.plan.pieces) {
      const Rect& r = home.plan.floor.rooms[static_cast<size_t>(piece.room)].inner;
      for (const Vec2& c : corners(piece.box)) {
        EXPECT_GE(std::min(c.x - r.x0, c.y - r.z0), -1e-3f) << piece.name << ", seed " << seed;
        EXPECT_LE(std::max(c.x - r.x1, c.y - r.z1), 1e-3f) << piece.name << ", seed " << seed;
      }
      EXPECT_LE(piece.box.high, home.plan.floor.height + 1e-3f) << piece.name;
      if (piece.parent < 0) continue;
      const PlacedPiece& below = home.plan.pieces[static_cast<size_t>(piece.parent)];
      EXPECT_LE(piece.box.low, below.box.high + 1e-3f)
          << piece.name << " floats over " << below.name;
    }
  }
}

TEST(Homes, RoomsHaveWhatTheyAreNamedAfter) {
  const std::map<RoomType, std::string> wanted{
      {RoomType::Bedroom, "bed"},         {RoomType::Living, "sofa"},
      {RoomType::Kitchen, "kitchen run"}, {RoomType::Bathroom, "toilet"},
      {RoomType::Study, "desk"},          {RoomType::Dining, "dining table"}};
  int rooms = 0, without = 0;
  for (const Home& home : all_homes()) {
    for (size_t r = 0; r < home.plan.floor.rooms.size(); ++r) {
      const RoomType type = home.plan.floor.rooms[r].type;
      if (!wanted.contains(type)) continue;
      ++rooms;
      without +=
          std::none_of(home.plan.pieces.begin(), home.plan.pieces.end(), [&](const PlacedPiece& p) {
            return p.room == static_cast<int>(r) && p.name == wanted.at(type);
          });
    }
  }
  EXPECT_GT(rooms, 30);
  EXPECT_LE(without, rooms / 15);
}

TEST(Homes, DoorsAndWindowsStayFree) {
  int doors = 0, windows = 0;
  for (uint64_t seed = 0; seed < kHomes; ++seed) {
    const Home& home = all_homes()[seed];
    const FloorPlan& plan = home.plan.floor;
    for (int room = 0; room < static_cast<int>(plan.rooms.size()); ++room) {
      for (const Opening& o : plan.openings_of(room)) {
        const bool window = o.kind == OpeningKind::Window;
        ++(window ? windows : doors);
        const OrientedBox zone =
            upright(window ? before(plan, o, 0.28f, o.bottom, o.top) : before(plan, o, 0.7f, 0, 2));
        for (const PlacedPiece& piece : home.plan.pieces) {
          if (window && piece.name == "curtains") continue;
          EXPECT_LT(common_volume(zone, piece.box), 1e-7)
              << piece.name << " before a " << (window ? "window" : "door") << ", seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(doors, 40);
  EXPECT_GT(windows, 25);
}

TEST(Homes, CeilingLightsAreFlushAndClearOfWallsAndOfTallThings) {
  size_t lights = 0;
  for (uint64_t seed = 0; seed < kHomes; ++seed) {
    const HomePlan& plan = all_homes()[seed].plan;
    lights += plan.ceiling_lights.size();
    for (const Bounds& light : plan.ceiling_lights) {
      EXPECT_EQ(light.high.y, plan.floor.height);
      EXPECT_LE(light.extent().y, 0.021f);
      int inside = 0;
      for (const PlanRoom& r : plan.floor.rooms)
        inside +=
            light.low.x >= r.inner.x0 + 0.4f - 1e-3f && light.high.x <= r.inner.x1 - 0.4f + 1e-3f &&
            light.low.z >= r.inner.z0 + 0.4f - 1e-3f && light.high.z <= r.inner.z1 - 0.4f + 1e-3f;
      EXPECT_EQ(inside, 1) << "nearer than 0.4 m to a wall, seed " << seed;
      Bounds zone = light;
      zone.low = zone.low - Vec3{0.3f, 0.69f, 0.3f} + Vec3{1e-3f, 0, 1e-3f};
      zone.high = zone.high + Vec3{0.3f, 0, 0.3f} - Vec3{1e-3f, 0, 1e-3f};
      for (const PlacedPiece& piece : plan.pieces)
        EXPECT_LT(common_volume(upright(zone), piece.box), 1e-7)
            << piece.name << " under a light, seed " << seed;
    }
  }
  EXPECT_GT(lights, 30u);
}

TEST(Homes, EachLuminaireIsALightGroupOfItsOwn) {
  for (const Home& home : all_homes()) {
    ASSERT_GE(home.scene.light_groups.size(), 1u);
    std::vector<int> found(home.scene.light_groups.size(), 0);
    for (const scene::Instance& instance : home.scene.instances) {
      const auto& mesh = home.scene.meshes[static_cast<size_t>(instance.mesh)];
      const bool emits = home.scene.materials[static_cast<size_t>(mesh.material)].emissive();
      ASSERT_EQ(emits, instance.light_group != scene::kNone);
      if (emits) ++found[static_cast<size_t>(instance.light_group)];
    }
    for (const scene::PunctualLight& light : home.scene.lights)
      ++found[static_cast<size_t>(light.light_group)];
    for (const int count : found) EXPECT_EQ(count, 1);
  }
}

TEST(Homes, TrianglesFollowDetailFromFiftyThousandToThreeMillion) {
  const auto triangles = [](int64_t rooms, double detail, uint64_t seed) {
    HomeConfig config = coarse();
    config.rooms = {rooms, rooms};
    config.detail = {detail, detail};
    return generate_home(config, seed).scene.triangle_count();
  };
  const HomeConfig defaults;
  for (const uint64_t seed : {2, 5}) {
    const int64_t fewest = triangles(1, defaults.detail.low, seed);
    EXPECT_GE(fewest, 50'000) << seed;
    EXPECT_GT(triangles(1, 2 * defaults.detail.low, seed), 2 * fewest) << seed;
  }
  const int64_t most = triangles(6, defaults.detail.high, 3);
  EXPECT_GE(most, 500'000);
  EXPECT_LE(most, 3'000'000);
}

TEST(Homes, AlbedosAndTextureCoordinatesAreInRange) {
  for (const Home& home : all_homes()) {
    for (const scene::Material& material : home.scene.materials) {
      if (material.base_color_texture.texture != scene::kNone) {
        EXPECT_EQ(material.base_color, (Rgb{1, 1, 1}));
        continue;
      }
      if (material.name == "pane" && max_component(material.emission) > 0) {
        EXPECT_EQ(material.base_color, Rgb{});  // what meets it leaves the home
        continue;
      }
      EXPECT_GE(std::min({material.base_color.x, material.base_color.y, material.base_color.z}),
                0.03f)
          << material.name;
      EXPECT_LE(max_component(material.base_color), 0.85f) << material.name;
    }
    for (const scene::Mesh& mesh : home.scene.meshes) {
      ASSERT_EQ(mesh.uvs[0].size(), mesh.positions.size());
      for (const Vec3& p : mesh.positions) ASSERT_TRUE(is_finite(p)) << mesh.name;
      for (const Vec2& uv : mesh.uvs[0])
        ASSERT_TRUE(std::abs(uv.x) < 1e3f && std::abs(uv.y) < 1e3f) << mesh.name;
    }
  }
}

TEST(Homes, NoRayEscapesAndAlmostAllMeetAFront) {
  int64_t rays = 0, backs = 0;
  for (const Home& home : all_homes()) {
    const pathtrace::Bvh bvh(home.scene);
    ASSERT_FALSE(home.scene.cameras.empty());
    Rng rng(1);
    for (const scene::Camera& camera : home.scene.cameras) {
      for (int i = 0; i < 2000; ++i) {
        const float y = rng.uniform(-1, 1), phi = rng.uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
        const Vec3 direction{r * std::cos(phi), y, r * std::sin(phi)};
        const pathtrace::Hit hit = bvh.intersect({camera.origin, direction});
        ASSERT_TRUE(hit.valid()) << "light leaks out of a " << camera.name;
        ++rays;
        backs += dot(hit.normal, direction) >= 0;
      }
    }
  }
  EXPECT_GT(rays, 50'000);
  EXPECT_LE(backs, rays / 1000) << "something is open or inside out";
}

}  // namespace
}  // namespace lte::datagen::homes
