// The points of a picture that are asked for light: pixels on a grid, and its last row and column.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "infer/renderer/tile_cover.h"
#include "lte/base/parallel.h"
#include "lte/gi/upsample.h"

namespace lte::infer {

struct PictureGrid {
  int width = 0;  ///< of the picture, in pixels
  gi::GridAxis columns, rows;

  PictureGrid(int step, int picture_width, int picture_height)
      : width(picture_width), columns(step, picture_width), rows(step, picture_height) {}

  size_t size() const {
    return static_cast<size_t>(columns.count()) * static_cast<size_t>(rows.count());
  }
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns.count()) +
           static_cast<size_t>(column);
  }
  int column_of(size_t index) const {
    return static_cast<int>(index % static_cast<size_t>(columns.count()));
  }
  int row_of(size_t index) const {
    return static_cast<int>(index / static_cast<size_t>(columns.count()));
  }
  size_t pixel(int column, int row) const {
    return static_cast<size_t>(rows.at(row)) * static_cast<size_t>(width) +
           static_cast<size_t>(columns.at(column));
  }
  /// With so many points around it, as far as the grid goes.
  TileRect around(const TileRect& part, int points) const {
    return {std::max(0, part.left - points), std::max(0, part.top - points),
            std::min(columns.count(), part.right + points),
            std::min(rows.count(), part.bottom + points)};
  }
  TileRect all() const { return {0, 0, columns.count(), rows.count()}; }

  /// Calls use(number in the part, number on the grid, pixel) for all of it, in several threads.
  template <typename Use>
  void for_part(const TileRect& part, const Use& use) const {
    constexpr int64_t kRows = 8;  // that a thread takes at a time
    parallel_for(part.bottom - part.top, kRows, [&](int64_t begin, int64_t end) {
      for (int j = part.top + static_cast<int>(begin); j < part.top + static_cast<int>(end); ++j) {
        size_t small =
            static_cast<size_t>(j - part.top) * static_cast<size_t>(part.right - part.left);
        for (int i = part.left; i < part.right; ++i) use(small++, index(i, j), pixel(i, j));
      }
    });
  }

  /// Calls use(number on the grid, pixel) for all of the grid, in several threads.
  template <typename Use>
  void for_all(const Use& use) const {
    for_part(all(), [&](size_t, size_t on_grid, size_t pixel) { use(on_grid, pixel); });
  }
};

}  // namespace lte::infer
