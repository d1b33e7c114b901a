#include "lte/radiosity/occupancy_grid.h"

#include <gtest/gtest.h>

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

bool sees(const OccupancyGrid& grid, const Vec3& a, const Vec3& a_normal, const Vec3& b,
          const Vec3& b_normal) {
  std::vector<uint8_t> visible;
  const OccupancyGrid::End other = {b, b_normal};
  grid.see({a, a_normal}, {&other, 1}, &visible);
  return visible[0] != 0;
}

TEST(OccupancyGrid, APlateHidesWhatIsBehindIt) {
  const OccupancyGrid grid(plate(), 0.025f);
  EXPECT_FALSE(sees(grid, {0.5f, 0.5f, 0}, kUp, {0.5f, 0.5f, 1}, -kUp));
  EXPECT_FALSE(sees(grid, {0.1f, 0.2f, 0}, kUp, {0.8f, 0.9f, 1}, -kUp));
  EXPECT_FALSE(sees(grid, {0.8f, 0.9f, 1}, -kUp, {0.1f, 0.2f, 0}, kUp));
  EXPECT_FALSE(sees(grid, {0.5f, 0.5f, 0.45f}, kUp, {0.5f, 0.5f, 1}, -kUp)) << "close to it";
}

TEST(OccupancyGrid, NothingStandsBesideIt) {
  const OccupancyGrid grid(plate(), 0.025f);
  EXPECT_TRUE(sees(grid, {1.2f, 0.5f, 0}, kUp, {1.2f, 0.5f, 1}, -kUp));
  EXPECT_TRUE(sees(grid, {0, 0, 0.2f}, kUp, {1, 1, 0.2f}, kUp));
  EXPECT_TRUE(sees(grid, {-50, 0.5f, 40}, kUp, {0.5f, 0.5f, 0.8f}, kUp));
}

TEST(OccupancyGrid, AnEndOnThePlateDoesNotHideItself) {
  const OccupancyGrid grid(plate(), 0.025f);
  EXPECT_TRUE(sees(grid, {0.5f, 0.5f, 0.5f}, kUp, {0.5f, 0.5f, 1}, -kUp));
  EXPECT_TRUE(sees(grid, {0.1f, 0.1f, 0.5f}, kUp, {0.9f, 0.9f, 0.51f}, -kUp)) << "grazing";
  const Vec3 across = {1, 0, 0};  // an end of another surface in the same place
  EXPECT_FALSE(sees(grid, {0.5f, 0.5f, 0.5f}, across, {0.7f, 0.5f, 1}, -kUp));
}

TEST(OccupancyGrid, TellsTheCellOfWhatIsInside) {
  const OccupancyGrid grid(plate(), 0.025f);
  const std::optional<int32_t> cell = grid.cell_of({0.5f, 0.5f, 0.5f});
  ASSERT_TRUE(cell);
  EXPECT_EQ(grid.cell_of({0.5f, 0.5f, 0.501f}), cell);
  EXPECT_NE(grid.cell_of({0.53f, 0.5f, 0.5f}), cell);
  EXPECT_FALSE(grid.cell_of({0.5f, 0.5f, 0.8f}));
  EXPECT_FALSE(grid.cell_of({-1, 0.5f, 0.5f}));
  EXPECT_FALSE(grid.cell_of({NAN, 0.5f, 0.5f}));
}

TEST(OccupancyGrid, ManyAreSeenAsEachIsAlone) {
  const OccupancyGrid grid(plate(), 0.025f);
  std::vector<OccupancyGrid::End> others;
  for (int i = 0; i < 150; ++i)
    others.push_back({{0.015f * static_cast<float>(i) - 0.5f, 0.4f, 1}, -kUp});
  std::vector<uint8_t> visible;
  grid.see({{0.5f, 0.5f, 0}, kUp}, others, &visible);
  for (size_t i = 0; i < others.size(); ++i) {
    EXPECT_EQ(visible[i] != 0, sees(grid, {0.5f, 0.5f, 0}, kUp, others[i].position, -kUp)) << i;
    // The segment passes the plate's height half way.
    const float x = (0.5f + others[i].position.x) / 2;
    if (x > 0.05f && x < 0.95f) {
      EXPECT_EQ(visible[i], 0) << i;
    } else if (x < -0.05f || x > 1.05f) {
      EXPECT_EQ(visible[i], 1) << i;
    }
  }
}

TEST(OccupancyGrid, WithoutPointsOrInOnePlaceAllIsVisible) {
  EXPECT_TRUE(sees(OccupancyGrid({}, 0.1f), {0, 0, 0}, kUp, {1, 1, 1}, kUp));
  const std::vector<Vec3> one(3, Vec3{5, 5, 5});
  const OccupancyGrid grid(one, 0);
  EXPECT_GT(grid.cell(), 0);
  EXPECT_TRUE(sees(grid, {0, 0, 0}, kUp, {1, 1, 1}, kUp));
}

TEST(OccupancyGrid, CellsGrowWhereThereWouldBeTooMany) {
  const std::vector<Vec3> far = {{0, 0, 0}, {1000, 1000, 1000}};
  EXPECT_GE(OccupancyGrid(far, 1e-6f).cell(), 0.1f);
}

}  // namespace
}  // namespace lte::radiosity
