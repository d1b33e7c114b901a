// Cells of light against means by hand.
#include "lte/gi/light_cells.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::gi {
namespace {

constexpr Vec3 kUp{0, 1, 0};

CellLight light(float value, float rays) { return {{value, 0, 0}, {0, value, 0}, rays, 2 * rays}; }

TEST(LightCells, KeepTheMeanOfAllRaysOfACell) {
  LightCells cells;
  cells.begin_view();
  const Vec3 place{0.26f, 0, 0.26f};
  EXPECT_EQ(cells.find(place, kUp, 0.2f), nullptr);
  cells.add(place, kUp, 0.2f, light(1, 2));
  cells.add(place + Vec3{0.005f, 0, 0.005f}, kUp, 0.2f, light(4, 6));
  const CellLight* found = cells.find(place, kUp, 0.2f);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->direct.x, (1 * 2 + 4 * 6) / 8.0, 1e-6);
  EXPECT_NEAR(found->indirect.y, (1 * 4 + 4 * 12) / 16.0, 1e-6);
  EXPECT_EQ(found->direct_rays, 8);
  EXPECT_EQ(found->indirect_rays, 16);
  EXPECT_EQ(cells.size(), 1);
}

TEST(LightCells, DoNotMixSidesPlacesOrExtents) {
  LightCells cells;
  const Vec3 place{0.26f, 0, 0.26f};
  cells.add(place, kUp, 0.2f, light(1, 2));
  EXPECT_EQ(cells.find(place, -kUp, 0.2f), nullptr);
  EXPECT_EQ(cells.find(place, Vec3{1, 0, 0}, 0.2f), nullptr);
  EXPECT_EQ(cells.find(place + Vec3{0.5f, 0, 0}, kUp, 0.2f), nullptr);
  EXPECT_EQ(cells.find(place, kUp, 0.05f), nullptr);
}

/// A cell is at most twice as wide as what it stands for.
TEST(LightCells, AreAsWideAsTheirExtentOrUpToTwice) {
  for (const float extent : {0.1f, 0.126f, 0.2f, 0.25f, 3.0f}) {
    LightCells cells;
    Rng rng(7);
    int64_t found = 0, wide = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p{1000 * extent * rng.uniform(), 0, 1000 * extent * rng.uniform()};
      cells.add(p, kUp, extent, light(1, 1));
      found += cells.find(p + Vec3{0.1f * extent, 0, 0}, kUp, extent) != nullptr ? 1 : 0;
      // By chance one cell in a hundred has a point.
      wide += cells.find(p + Vec3{2.001f * extent, 0, 0}, kUp, extent) != nullptr ? 1 : 0;
    }
    EXPECT_GT(found, 1700) << extent;
    EXPECT_LT(wide, 60) << extent;
  }
}

/// Walls at round coordinates: rounding does not scatter their places over cells.
TEST(LightCells, RoundingOfAWallDoesNotMatter) {
  LightCells cells;
  Rng rng(3);
  for (const float height : {0.0f, 1.0f, 2.5f, -0.25f}) {
    for (int i = 0; i < 50; ++i) {
      const Vec3 p{0.3f, height + 1e-6f * (rng.uniform() - 0.5f), 0.3f};
      const Vec3 n = normalize(Vec3{1e-6f * (rng.uniform() - 0.5f), -1, 1e-6f * rng.uniform()});
      cells.add(p, n, 0.01f, light(1, 1));
    }
  }
  EXPECT_EQ(cells.size(), 4);
}

TEST(LightCells, BeyondTheirNumberForgetWhatTheLastViewsDidNotShow) {
  LightCells cells(100);
  const auto show = [&](int first, int count) {
    const int view = cells.begin_view();
    for (int i = first; i < first + count; ++i)
      cells.add({static_cast<float>(i), 0.1f, 0.1f}, kUp, 0.1f, light(1, 1));
    return view;
  };
  EXPECT_EQ(show(0, 80), 0);
  EXPECT_EQ(show(100, 80), 1);
  EXPECT_EQ(cells.size(), 160);
  show(200, 10);
  EXPECT_EQ(cells.size(), 170) << "both are of the last two views";
  show(200, 10);
  EXPECT_EQ(cells.size(), 90) << "the first view's are gone";
  EXPECT_EQ(cells.find({5, 0.1f, 0.1f}, kUp, 0.1f), nullptr);
  EXPECT_NE(cells.find({105, 0.1f, 0.1f}, kUp, 0.1f), nullptr);
  EXPECT_EQ(cells.find({105, 0.1f, 0.1f}, kUp, 0.1f)->direct_rays, 1);
  EXPECT_THROW(LightCells(0), Error);
}

/// What a view from nearer knows serves one from farther, and not the other way round: it would
/// blur.
TEST(LightCells, FinerCellsAnswerForWiderOnes) {
  const Vec3 place{0.26f, 0, 0.26f};
  for (const auto& [factor, known] :
       {std::pair{0.5f, false}, {1.0f, true}, {2.0f, true}, {4.0f, true}, {8.0f, false}}) {
    LightCells cells;
    cells.begin_view();
    cells.add(place, kUp, 0.02f, light(3, 2));
    const CellLight* found = cells.find(place, kUp, 0.02f * factor);
    ASSERT_EQ(found != nullptr, known) << factor;
    if (!known) continue;
    EXPECT_EQ(found->direct.x, 3);
    cells.add(place, kUp, 0.02f * factor, light(6, 1));  // its own cell begins with that
    EXPECT_EQ(cells.size(), factor > 1 ? 2 : 1);
    const CellLight* own = cells.find(place, kUp, 0.02f * factor);
    EXPECT_EQ(own->direct_rays, 3);
    EXPECT_NEAR(own->direct.x, 4, 1e-6);
    EXPECT_EQ(cells.find(place, kUp, 0.02f)->direct_rays, factor > 1 ? 2 : 3);
  }
}

/// A view that needs no rays keeps the finer cells that it reads.
TEST(LightCells, ShownByAViewFromFartherStay) {
  LightCells cells(1);
  cells.begin_view();
  cells.add({5, 0.1f, 0.1f}, kUp, 0.1f, light(1, 1));
  cells.add({9, 0.1f, 0.1f}, kUp, 0.1f, light(1, 1));
  for (int view = 0; view < 4; ++view) {
    cells.begin_view();
    cells.add({5, 0.1f, 0.1f}, kUp, 0.2f, {});
  }
  EXPECT_EQ(cells.size(), 1);
  EXPECT_NE(cells.find({5, 0.1f, 0.1f}, kUp, 0.1f), nullptr);
}

TEST(LightCells, WithoutRaysAddNothing) {
  LightCells cells;
  cells.add({1, 1, 1}, kUp, 0.1f, {});
  EXPECT_EQ(cells.size(), 0);
}

}  // namespace
}  // namespace lte::gi
