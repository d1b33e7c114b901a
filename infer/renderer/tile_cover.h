// Rectangles over the tiles of a picture that need work.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lte::infer {

/// Columns and rows from left and top to right and bottom, the last ones not included.
struct TileRect {
  int left, top, right, bottom;

  int64_t size() const { return int64_t{right - left} * (bottom - top); }
  bool contains(int column, int row) const {
    return column >= left && column < right && row >= top && row < bottom;
  }
  friend bool operator==(const TileRect&, const TileRect&) = default;
};

/// Rectangles that cover the marked tiles of a picture, none twice and no other: each as wide as
/// marks go on to the right, and then as tall as the whole of it goes on below.
/// @param marked  [rows * columns], not 0 for a mark
std::vector<TileRect> cover_tiles(std::span<const uint8_t> marked, int columns, int rows);

}  // namespace lte::infer
