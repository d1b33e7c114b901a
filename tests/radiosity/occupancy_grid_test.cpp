#include "lte/radiosity/occupancy_grid.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::radiosity {
namespace {

/// A square plate of side 1 in the plane z = 0.5, of points 0.02 apart.
std::vector<Vec3> plate() {
  std::vector<Vec3> points;
  for (int i = 0; i <= 50; ++i) {
    for (int j = 0; j <= 50; ++j)
      points.push_back({0.02f * static_cast<float>(i), 0.02f * static_cast<float>(j), 0.5f});
  }
  return points;
}

const Vec3 kUp = {0, 0, 1};

OccupancyGrid grid_of(const std::vector<Vec3>& points, float cell, const Vec3& normal = kUp) {
  return {points, std::vector<Vec3>(points.size(), normal), cell};
}

bool sees(const OccupancyGrid& grid, const Vec3& a, const Vec3& b) {
  std::vector<uint8_t> visible;
  grid.see(a, {&b, 1}, &visible);
  return visible[0] != 0;
}

TEST(OccupancyGrid, APlateHidesWhatIsBehindIt) {
  for (const Vec3& normal : {kUp, -kUp}) {
    const OccupancyGrid grid = grid_of(plate(), 0.025f, normal);
    EXPECT_FALSE(sees(grid, {0.5f, 0.5f, 0}, {0.5f, 0.5f, 1}));
    EXPECT_FALSE(sees(grid, {0.1f, 0.2f, 0}, {0.8f, 0.9f, 1}));
    EXPECT_FALSE(sees(grid, {0.8f, 0.9f, 1}, {0.1f, 0.2f, 0}));
    EXPECT_FALSE(sees(grid, {0.5f, 0.5f, 0.45f}, {0.5f, 0.5f, 1})) << "close to it";
  }
}

TEST(OccupancyGrid, NothingStandsBesideIt) {
  const OccupancyGrid grid = grid_of(plate(), 0.025f);
  EXPECT_TRUE(sees(grid, {1.2f, 0.5f, 0}, {1.2f, 0.5f, 1}));
  EXPECT_TRUE(sees(grid, {0, 0, 0.2f}, {1, 1, 0.2f}));
  EXPECT_TRUE(sees(grid, {-50, 0.5f, 40}, {0.5f, 0.5f, 0.8f}));
}

TEST(OccupancyGrid, AnEndOnThePlateDoesNotHideItself) {
  const OccupancyGrid grid = grid_of(plate(), 0.025f);
  EXPECT_TRUE(sees(grid, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 1}));
  EXPECT_TRUE(sees(grid, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0}));
  EXPECT_TRUE(sees(grid, {0.1f, 0.1f, 0.5f}, {0.9f, 0.9f, 0.51f})) << "grazing";
}

TEST(OccupancyGrid, ASegmentThatFollowsAWallIsNotHiddenByIt) {
  const OccupancyGrid grid = grid_of(plate(), 0.025f);
  for (const float above : {0.002f, 0.012f, 0.03f}) {
    EXPECT_TRUE(sees(grid, {0.05f, 0.5f, 0.5f + above}, {0.95f, 0.4f, 0.5f + above})) << above;
    EXPECT_TRUE(sees(grid, {0.05f, 0.5f, 0.5f - above}, {0.95f, 0.4f, 0.5f - above})) << above;
  }
}

TEST(OccupancyGrid, WhatElseIsAskedChangesNothing) {
  // Marches share vectors, and go on where others ended.
  std::vector<Vec3> points, normals, others;
  Rng rng(3);
  for (int plane = 0; plane < 6; ++plane) {
    for (int i = 0; i < 400; ++i) {
      Vec3 p = {rng.uniform(), rng.uniform(), rng.uniform()}, n;
      p[plane % 3] = 0.15f + 0.7f * static_cast<float>(plane) / 5;
      n[plane % 3] = 1;
      if (rng.uniform() < 0.6f) points.push_back(p), normals.push_back(n);
    }
  }
  const OccupancyGrid grid(points, normals, 0.03f);
  for (int i = 0; i < 1'300; ++i)
    others.push_back({3 * rng.uniform() - 1, rng.uniform(), rng.uniform()});
  others[700] = others[3] = {0.1f, 0.2f, 0.9f};
  for (const Vec3& a : {Vec3{0.1f, 0.2f, 0.9f}, Vec3{0.5f, 0.5f, 0.5f}, Vec3{-2, 0.5f, 0.4f}}) {
    std::vector<uint8_t> together;
    grid.see(a, others, &together);
    ASSERT_EQ(together.size(), others.size());
    size_t seen = 0;
    for (size_t i = 0; i < others.size(); ++i) {
      EXPECT_EQ(together[i] != 0, sees(grid, a, others[i])) << i;
      seen += together[i];
    }
    EXPECT_GT(seen, others.size() / 50);
    EXPECT_LT(seen, others.size() * 49 / 50);
  }
}

/// Points of the unit square in the plane z = 0.5 but for a slit around y = 0.5, `density` a cell.
std::vector<Vec3> drawn_at_random(float density, float cell, float slit) {
  std::vector<Vec3> points;
  Rng rng(1);
  const auto count = static_cast<int>(density / (cell * cell));
  for (int i = 0; i < count; ++i) {
    const float x = rng.uniform(), y = rng.uniform();
    if (std::abs(y - 0.5f) >= slit / 2) points.push_back({x, y, 0.5f});
  }
  return points;
}

/// Of segments through the plane z = 0.5, which share lies free: between `low` and `high` of y.
double open_share(const OccupancyGrid& grid, float low, float high) {
  Rng rng(2);
  int open = 0;
  constexpr int kSegments = 2000;
  for (int i = 0; i < kSegments; ++i) {
    const Vec3 at = {rng.uniform(0.05f, 0.95f), rng.uniform(low, high), 0.5f};
    const Vec3 along = {rng.uniform(-0.5f, 0.5f), rng.uniform(-0.5f, 0.5f), 1};
    open += sees(grid, at - along * 0.4f, at + along * 0.4f);
  }
  return static_cast<double>(open) / kSegments;
}

TEST(OccupancyGrid, AWallOfPointsDrawnAtRandomHasHardlyAHole) {
  // As densely as the solver has them: seven of ten cells of a wall have no point.
  constexpr float kCell = 0.025f, kDensity = 0.36f;
  const OccupancyGrid grid = grid_of(drawn_at_random(kDensity, kCell, 0), kCell);
  EXPECT_LT(open_share(grid, 0.05f, 0.95f), 0.1);
}

TEST(OccupancyGrid, ADoorwayStaysOpen) {
  constexpr float kCell = 0.025f, kSlit = 0.25f;
  const OccupancyGrid grid = grid_of(drawn_at_random(0.36f, kCell, kSlit), kCell);
  EXPECT_GT(open_share(grid, 0.5f - kSlit / 2 + kCell, 0.5f + kSlit / 2 - kCell), 0.99);
  EXPECT_LT(open_share(grid, 0.05f, 0.5f - kSlit / 2 - kCell), 0.1);
}

TEST(GridShape, TellsTheCellOfWhatIsInside) {
  const GridShape grid = GridShape::around(plate(), 0.025f);
  const std::optional<int32_t> cell = grid.cell_of({0.5f, 0.5f, 0.5f});
  ASSERT_TRUE(cell);
  EXPECT_EQ(grid.cell_of({0.5f, 0.5f, 0.501f}), cell);
  EXPECT_NE(grid.cell_of({0.53f, 0.5f, 0.5f}), cell);
  EXPECT_FALSE(grid.cell_of({0.5f, 0.5f, 0.8f}));
  EXPECT_FALSE(grid.cell_of({-1, 0.5f, 0.5f}));
  EXPECT_FALSE(grid.cell_of({NAN, 0.5f, 0.5f}));
}

TEST(OccupancyGrid, ManyAreSeenAsEachIsAlone) {
  const OccupancyGrid grid = grid_of(plate(), 0.025f);
  std::vector<Vec3> others;
  for (int i = 0; i < 150; ++i) others.push_back({0.015f * static_cast<float>(i) - 0.5f, 0.4f, 1});
  std::vector<uint8_t> visible;
  grid.see({0.5f, 0.5f, 0}, others, &visible);
  for (size_t i = 0; i < others.size(); ++i) {
    EXPECT_EQ(visible[i] != 0, sees(grid, {0.5f, 0.5f, 0}, others[i])) << i;
    // The segment passes the plate's height half way.
    const float x = (0.5f + others[i].x) / 2;
    if (x > 0.05f && x < 0.95f) {
      EXPECT_EQ(visible[i], 0) << i;
    } else if (x < -0.05f || x > 1.05f) {
      EXPECT_EQ(visible[i], 1) << i;
    }
  }
}

TEST(OccupancyGrid, WithoutPointsOrInOnePlaceAllIsVisible) {
  EXPECT_TRUE(sees(grid_of({}, 0.1f), {0, 0, 0}, {1, 1, 1}));
  const OccupancyGrid grid = grid_of(std::vector<Vec3>(3, Vec3{5, 5, 5}), 0);
  EXPECT_GT(grid.shape().cell, 0);
  EXPECT_TRUE(sees(grid, {0, 0, 0}, {1, 1, 1}));
  EXPECT_TRUE(sees(grid_of(plate(), 0.025f, {}), {0.5f, 0.5f, 0}, {0.5f, 0.5f, 1}))
      << "normals of no direction";
}

TEST(GridShape, CellsGrowWhereThereWouldBeTooMany) {
  const std::vector<Vec3> far = {{0, 0, 0}, {1000, 1000, 1000}};
  EXPECT_GE(GridShape::around(far, 1e-6f).cell, 0.1f);
}

}  // namespace
}  // namespace lte::radiosity
