// What the table says between its entries, and where it has nothing to say.
#include "lte/gi/radiosity_table.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

/// n x n entries over [0, 1]² at height z, of the side `normal`; irradiance by `light(x, y)`.
template <typename Light>
void add_grid(int n, float z, const Vec3& normal, const Light& light, TableEntries* entries,
              std::vector<Rgb>* irradiance) {
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(n);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(n);
      entries->position.push_back({u, v, z});
      entries->normal.push_back(normal);
      entries->albedo.push_back({0.5f, 0.5f, 0.5f});
      entries->area.push_back(1 / static_cast<float>(n * n));
      irradiance->push_back(light(u, v));
    }
  }
}

scene::Scene sheet() {
  scene::Scene scene;
  add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add_material(&scene, {0.5f, 0.5f, 0.5f}));
  return scene;
}

TEST(RadiosityTable, FollowsALinearFieldBetweenEntries) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  TableEntries entries;
  std::vector<Rgb> light;
  const auto field = [](float x, float y) { return Rgb{1 + x, 2 - y, x + y}; };
  add_grid(20, 0, {0, 0, 1}, field, &entries, &light);
  const RadiosityTable table(bvh, entries, light);
  EXPECT_EQ(table.size(), 400);
  for (const Vec2& p : {Vec2{0.31f, 0.47f}, Vec2{0.5f, 0.5f}, Vec2{0.774f, 0.213f}}) {
    Rgb found;
    ASSERT_TRUE(table.lookup({p.x, p.y, 0}, {0, 0, 1}, &found));
    const Rgb expected = field(p.x, p.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.01f);
  }
}

TEST(RadiosityTable, KeepsTheSidesOfAWallApart) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  TableEntries entries;
  std::vector<Rgb> light;
  add_grid(
      20, 0, {0, 0, 1},
      [](float, float) {
        return Rgb{1, 1, 1};
      },
      &entries, &light);
  add_grid(
      20, 0, {0, 0, -1},
      [](float, float) {
        return Rgb{5, 5, 5};
      },
      &entries, &light);
  // Another wall that faces the same way, two centimetres behind.
  add_grid(
      20, -0.02f, {0, 0, 1},
      [](float, float) {
        return Rgb{9, 9, 9};
      },
      &entries, &light);
  const RadiosityTable table(bvh, entries, light);
  Rgb found;
  ASSERT_TRUE(table.lookup({0.4f, 0.6f, 0}, {0, 0, 1}, &found));
  EXPECT_FLOAT_EQ(found.x, 1);
  ASSERT_TRUE(table.lookup({0.4f, 0.6f, 0}, {0, 0, -1}, &found));
  EXPECT_FLOAT_EQ(found.x, 5);
}

TEST(RadiosityTable, AFloorEndsAtAWallThatStandsOnIt) {
  scene::Scene scene = sheet();
  // At y = 0.5, thin; one side of the floor is bright, the other dark.
  add_quad(&scene, {0, 0.5f, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  const pathtrace::Bvh bvh(scene);
  TableEntries entries;
  std::vector<Rgb> light;
  const auto step = [](float, float y) { return y < 0.5f ? Rgb{1, 1, 1} : Rgb{}; };
  add_grid(20, 0, {0, 0, 1}, step, &entries, &light);
  const RadiosityTable table(bvh, entries, light);
  for (const float x : {0.2f, 0.333f, 0.5f, 0.81f}) {
    Rgb found;
    ASSERT_TRUE(table.lookup({x, 0.49f, 0}, {0, 0, 1}, &found));
    EXPECT_FLOAT_EQ(found.x, 1) << x;
    ASSERT_TRUE(table.lookup({x, 0.51f, 0}, {0, 0, 1}, &found));
    EXPECT_EQ(found.x, 0) << x;
  }
}

TEST(RadiosityTable, SaysWhereItKnowsNothing) {
  const scene::Scene scene = sheet();
  const pathtrace::Bvh bvh(scene);
  TableEntries entries;
  std::vector<Rgb> light;
  add_grid(
      10, 0, {0, 0, 1},
      [](float, float) {
        return Rgb{1, 1, 1};
      },
      &entries, &light);
  const RadiosityTable table(bvh, entries, light);
  Rgb found;
  EXPECT_FALSE(table.lookup({0.5f, 0.5f, 0}, {0, 0, -1}, &found));
  EXPECT_FALSE(table.lookup({0.5f, 0.5f, 0}, {1, 0, 0}, &found));
  EXPECT_FALSE(table.lookup({0.5f, 0.5f, 0.2f}, {0, 0, 1}, &found));
  EXPECT_FALSE(table.lookup({1.5f, 0.5f, 0}, {0, 0, 1}, &found));
  EXPECT_FALSE(RadiosityTable(bvh, {}, {}).lookup({0.5f, 0.5f, 0}, {0, 0, 1}, &found));
  EXPECT_THROW(RadiosityTable(bvh, entries, std::vector<Rgb>(3)), Error);
  light[7].y = NAN;
  EXPECT_THROW(RadiosityTable(bvh, entries, light), Error);
}

TEST(TableEntries, EstimatesInAClosedBoxAreThoseOfTheFurnaceInsideAndDarkOutside) {
  scene::Scene scene;
  const int wall = add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const TableEntries entries = sample_entries(scene, 200, 1);
  EXPECT_EQ(entries.size(), 200);
  double area = 0;
  for (const float a : entries.area) area += double{a};
  EXPECT_NEAR(area, 2 * 24, 0.1) << "both sides";
  const EntryLight light = estimate_entries(bvh, lights, entries, 512, 4, 1);
  const std::vector<uint8_t> keep = lit(light);
  const std::vector<Rgb> total = light.total();
  for (size_t i = 0; i < keep.size(); ++i) {
    // Inwards is towards the middle.
    const bool inside = dot(entries.position[i], entries.normal[i]) < 0;
    EXPECT_EQ(keep[i] != 0, inside);
    const double expected = inside ? double{kPi} * test::geometric_sum(0.5, 4) : 0;
    EXPECT_NEAR(double{total[i].x}, expected, 0.1 * expected);
  }
  EXPECT_EQ(entries.kept(keep).size(), 100);
}

}  // namespace
}  // namespace lte::gi
