#include "lte/radiosity/surfels.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace lte::radiosity {
namespace {

std::vector<Surfel> of(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                       GridShape* grid) {
  *grid = GridShape::around(positions, 0.1f);
  return surfels_of(positions, normals, *grid);
}

std::vector<Surfel> in_cell_of(const Vec3& p, const GridShape& grid,
                               const std::vector<Surfel>& surfels) {
  std::vector<Surfel> found;
  for (const Surfel& s : surfels)
    if (s.cell == grid.cell_of(p)) found.push_back(s);
  return found;
}

/// Far from what is looked at: its cells begin at multiples of 0.1.
const Vec3 kCorner = {0, 0, 0}, kUp = {0, 0, 1};

TEST(Surfels, PointsOfACellAreOneWhicheverWayTheyFace) {
  GridShape grid;
  const Vec3 tilted = normalize(Vec3{0.1f, 0, 1});
  const std::vector<Surfel> surfels =
      of({kCorner, {0.84f, 0.84f, 0.85f}, {0.86f, 0.86f, 0.85f}}, {kUp, tilted, -tilted}, &grid);
  ASSERT_EQ(surfels.size(), 2u);
  const auto found = in_cell_of({0.85f, 0.85f, 0.85f}, grid, surfels);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(length(found[0].middle - Vec3{0.85f, 0.85f, 0.85f}), 1e-5f);
  EXPECT_LT(length(found[0].normal - tilted), 1e-5f);
  EXPECT_TRUE(in_cell_of({0.5f, 0.5f, 0.5f}, grid, surfels).empty());
}

TEST(Surfels, WallsThatMeetInACellAreTwo) {
  GridShape grid;
  const std::vector<Surfel> surfels = of({kCorner, {0.83f, 0.84f, 0.85f}, {0.85f, 0.83f, 0.85f}},
                                         {kUp, {1, 0, 0}, {0, -1, 0}}, &grid);
  const auto found = in_cell_of({0.84f, 0.84f, 0.85f}, grid, surfels);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].normal.x, 1);
  EXPECT_EQ(found[1].normal.y, 1);
}

TEST(Surfels, BetweenTwoOfOnePlaneItIsClosed) {
  GridShape grid;
  const std::vector<Surfel> near = of({{0, 0, 0}, {0.35f, 0, 0}}, {kUp, -kUp}, &grid);
  std::set<int32_t> cells;
  for (const Surfel& s : near) {
    EXPECT_NEAR(s.middle.z, 0, 1e-6);
    EXPECT_NEAR(s.normal.z, 1, 1e-6);
    EXPECT_TRUE(cells.insert(s.cell).second);
  }
  EXPECT_GE(cells.size(), 4u);
  EXPECT_EQ(of({{0, 0, 0}, {0.6f, 0, 0}}, {kUp, kUp}, &grid).size(), 2u) << "a doorway";
  EXPECT_EQ(of({{0, 0, 0}, {0.35f, 0, 0.05f}}, {kUp, kUp}, &grid).size(), 2u) << "a step";
  const Vec3 bent = normalize(Vec3{0.5f, 0, 1});
  EXPECT_EQ(of({{0, 0, 0}, {0.35f, 0, 0}}, {kUp, bent}, &grid).size(), 2u) << "an edge";
}

TEST(Surfels, OfNoPointsThereAreNone) {
  GridShape grid;
  EXPECT_TRUE(of({}, {}, &grid).empty());
}

}  // namespace
}  // namespace lte::radiosity
