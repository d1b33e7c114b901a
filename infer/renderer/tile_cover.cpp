#include "infer/renderer/tile_cover.h"

#include <algorithm>
#include <cstddef>

#include "lte/base/check.h"

namespace lte::infer {

std::vector<TileRect> cover_tiles(std::span<const uint8_t> marked, int columns, int rows) {
  LTE_CHECK(columns >= 0 && rows >= 0 &&
                marked.size() == static_cast<size_t>(columns) * static_cast<size_t>(rows),
            "tiles: expected ", columns, " x ", rows, " marks, got ", marked.size());
  std::vector<uint8_t> open(marked.begin(), marked.end());
  const auto row_of = [&](int row, int left) {
    return open.begin() + int64_t{row} * columns + left;
  };
  const auto is_open = [](uint8_t mark) { return mark != 0; };
  std::vector<TileRect> out;
  for (int top = 0; top < rows; ++top) {
    for (int left = 0; left < columns; ++left) {
      if (!is_open(*row_of(top, left))) continue;
      const auto end = std::find(row_of(top, left), row_of(top, columns), uint8_t{0});
      const int right = left + static_cast<int>(end - row_of(top, left));
      int bottom = top;
      while (bottom < rows && std::all_of(row_of(bottom, left), row_of(bottom, right), is_open)) {
        std::fill(row_of(bottom, left), row_of(bottom, right), uint8_t{0});
        ++bottom;
      }
      out.push_back({left, top, right, bottom});
    }
  }
  return out;
}

}  // namespace lte::infer
