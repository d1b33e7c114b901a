// Homes that sun and sky light through their windows.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "datagen/homes/floor_plan.h"
#include "datagen/homes/home.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "tests/datagen/homes/coarse.h"

namespace lte::datagen::homes {
namespace {

/// Homes by day with suns, made once.
const std::vector<Home>& sunny_homes() {
  static const std::vector<Home> homes = [] {
    std::vector<Home> made;
    for (uint64_t seed = 0; made.size() < 6; ++seed) {
      HomeConfig config = coarse();
      config.rooms = {static_cast<int64_t>(seed % 6) + 1, static_cast<int64_t>(seed % 6) + 1};
      config.daylight_share = config.sun_share = 1;
      Home home = generate_home(config, seed);
      if (home.scene.environment) made.push_back(std::move(home));  // else it has no window
    }
    return made;
  }();
  return homes;
}

/// Whether a ray from inside leaves the home through a window.
bool leaves_by_window(const FloorPlan& plan, const Vec3& from, const Vec3& along) {
  for (const Opening& o : plan.openings) {
    if (o.kind != OpeningKind::Window) continue;
    const bool positive = o.side == Side::PosX || o.side == Side::PosZ;
    const int axis = along_z(o.side) ? 0 : 2;
    const float plane = plan.face(o.room, o.side) + (positive ? kRecess : -kRecess);
    const float t = (plane - from[axis]) / along[axis];
    const Vec3 p = from + along * t;
    const float across = p[2 - axis], slack = 1e-3f;
    if (t > 0 && across > o.from - slack && across < o.to + slack && p.y > o.bottom - slack &&
        p.y < o.top + slack)
      return true;
  }
  return false;
}

TEST(Homes, SunAndSkyComeInThroughWindowsAlone) {
  int64_t lit = 0, open = 0;
  for (const Home& home : sunny_homes()) {
    const pathtrace::Bvh bvh(home.scene);
    ASSERT_EQ(std::count_if(
                  home.scene.lights.begin(), home.scene.lights.end(),
                  [](const auto& light) { return light.kind == scene::LightKind::Directional; }),
              1);
    const scene::PunctualLight& sun = home.scene.lights.back();
    EXPECT_LT(sun.direction.y, -std::sin(10 * kPi / 180) + 1e-5f);
    const double ratio =
        luminance(sun.intensity) / (M_PI * luminance(home.scene.environment->radiance));
    EXPECT_GE(ratio, 0.999);
    EXPECT_LE(ratio, 6.001);
    Rng rng(1);
    for (const PlanRoom& room : home.plan.floor.rooms) {
      for (int i = 0; i < 1500; ++i) {
        const Vec3 from{rng.uniform(room.inner.x0 + 0.01f, room.inner.x1 - 0.01f),
                        rng.uniform(0.01f, home.plan.floor.height - 0.05f),
                        rng.uniform(room.inner.z0 + 0.01f, room.inner.z1 - 0.01f)};
        const float y = rng.uniform(-1, 1), phi = rng.uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
        for (const Vec3& along : {-sun.direction, Vec3{r * std::cos(phi), y, r * std::sin(phi)}}) {
          if (bvh.intersect({from, along}).valid()) continue;
          ++(along == -sun.direction ? lit : open);
          EXPECT_TRUE(leaves_by_window(home.plan.floor, from, along)) << room_name(room.type);
        }
      }
    }
    const Vec3 extent = home.scene.bounds().extent();
    EXPECT_LE(length(extent), kMaxHomeSphere);
    if (home.plan.floor.rooms.size() <= kMaxRoomsOfSmallHomes) {
      EXPECT_LE(length(extent), kMaxHomeExtent);
    }
  }
  EXPECT_GT(lit, 100) << "of places that the sun shines on";
  EXPECT_GT(open, 100);
}

TEST(Homes, WithoutSunsAreWhatTheyWere) {
  HomeConfig config = coarse();
  config.daylight_share = 1;
  const Home panes = generate_home(config, 3);
  EXPECT_FALSE(panes.scene.environment);
  config.sun_share = 1;
  const Home sunny = generate_home(config, 3);
  EXPECT_TRUE(sunny.scene.environment);
  EXPECT_EQ(panes.plan.floor.rooms.size(), sunny.plan.floor.rooms.size());
  const auto panes_of = [](const Home& home) {
    return std::count_if(home.scene.materials.begin(), home.scene.materials.end(),
                         [](const auto& material) { return material.name.starts_with("pane"); });
  };
  EXPECT_GT(panes_of(panes), 0);
  EXPECT_EQ(panes_of(sunny), 0);
}

}  // namespace
}  // namespace lte::datagen::homes
