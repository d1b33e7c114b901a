#include "infer/view/display_layers.h"

#include <gtest/gtest.h>

namespace lte::infer::view {
namespace {

image::Image gray(float value) {
  image::Image out(1, 1, 3);
  out.set_rgb(0, 0, {value, value, value});
  return out;
}

TEST(DisplayLayers, ADifferenceIsRedAboveAndBlueBelow) {
  const DisplayPicture above = display_difference(gray(0.6f), gray(0.5f), 1);
  EXPECT_GT(above.bytes[0], above.bytes[2]);
  const DisplayPicture below = display_difference(gray(0.5f), gray(0.6f), 1);
  EXPECT_GT(below.bytes[2], below.bytes[0]);
  EXPECT_EQ(display_difference(gray(0.5f), gray(0.5f), 1).bytes, (std::vector<uint8_t>{0, 0, 0}));
}

TEST(DisplayLayers, NormalsFillTheCube) {
  image::Image normal(2, 1, 3);
  normal.set_rgb(0, 0, {0, 1, -1});
  EXPECT_EQ(display_normal(normal).bytes, (std::vector<uint8_t>{128, 255, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace lte::infer::view
