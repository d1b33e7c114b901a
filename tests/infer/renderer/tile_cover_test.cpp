// Rectangles over marked tiles against the marks.
#include "infer/renderer/tile_cover.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::infer {
namespace {

TEST(TileCover, CoversEveryMarkOnceAndNothingElse) {
  Rng rng(11);
  for (int trial = 0; trial < 200; ++trial) {
    const int columns = 1 + static_cast<int>(rng.uniform() * 12),
              rows = 1 + static_cast<int>(rng.uniform() * 9);
    const float share = rng.uniform();
    std::vector<uint8_t> marked(static_cast<size_t>(columns * rows)), covered(marked.size());
    for (uint8_t& mark : marked) mark = rng.uniform() < share ? 1 : 0;
    for (const TileRect& rect : cover_tiles(marked, columns, rows)) {
      for (int row = rect.top; row < rect.bottom; ++row) {
        for (int column = rect.left; column < rect.right; ++column) {
          EXPECT_TRUE(rect.contains(column, row));
          ++covered[static_cast<size_t>(row * columns + column)];
        }
      }
    }
    EXPECT_EQ(covered, marked);
  }
}

TEST(TileCover, IsOneRectangleWhereThatIsEnough) {
  const std::vector<uint8_t> strip{0, 0, 1, 1,  //
                                   0, 0, 1, 1,  //
                                   0, 0, 1, 1};
  const TileRect wanted{2, 0, 4, 3};
  EXPECT_EQ(cover_tiles(strip, 4, 3), std::vector<TileRect>{wanted});
  EXPECT_EQ(wanted.size(), 6);
  EXPECT_TRUE(cover_tiles({}, 0, 0).empty());
  EXPECT_THROW(cover_tiles(strip, 4, 4), Error);
}

}  // namespace
}  // namespace lte::infer
