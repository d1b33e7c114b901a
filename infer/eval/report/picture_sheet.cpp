#include "infer/eval/report/picture_sheet.h"

#include <algorithm>

namespace lte::infer {
namespace {

using image::Image;

constexpr int kGap = 4;  // pixels between the pictures of a sheet

Image white_sheet(int width, int height) {
  Image out(width, height, 3);
  std::fill(out.pixels.begin(), out.pixels.end(), 1.0f);
  return out;
}

/// Draws each pixel of `picture` as a square of `zoom` pixels.
void paste(const Image& picture, int left, int top, int zoom, Image* sheet) {
  for (int y = 0; y < zoom * picture.height; ++y) {
    for (int x = 0; x < zoom * picture.width; ++x)
      sheet->set_rgb(left + x, top + y, picture.rgb(x / zoom, y / zoom));
  }
}

}  // namespace

Image side_by_side(const std::vector<Image>& pictures, int zoom) {
  const int step = zoom * pictures.front().width + kGap;
  Image row =
      white_sheet(static_cast<int>(pictures.size()) * step - kGap, zoom * pictures.front().height);
  for (size_t i = 0; i < pictures.size(); ++i)
    paste(pictures[i], static_cast<int>(i) * step, 0, zoom, &row);
  return row;
}

Image stacked(const std::vector<Image>& rows) {
  int width = 0, height = -kGap;
  for (const Image& row : rows) {
    width = std::max(width, row.width);
    height += row.height + kGap;
  }
  Image sheet = white_sheet(width, height);
  int top = 0;
  for (const Image& row : rows) {
    paste(row, 0, top, 1, &sheet);
    top += row.height + kGap;
  }
  return sheet;
}

}  // namespace lte::infer
