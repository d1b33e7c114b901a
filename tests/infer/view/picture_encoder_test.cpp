#include "infer/view/picture_encoder.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lte/image/png.h"

namespace lte::infer::view {
namespace {

DisplayPicture waves(int width, int height) {
  DisplayPicture out{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const double phase : {0.0, 2.0, 4.0})
        out.bytes.push_back(
            static_cast<uint8_t>(std::lround(127 + 100 * std::sin(0.11 * x + 0.07 * y + phase))));
    }
  }
  return out;
}

/// Root mean square over all bytes, by the decoder that reads scenes' textures.
double error_of(const DisplayPicture& picture, JpegQuality quality) {
  const image::Image back =
      image::decode_png(encode_jpeg(picture, quality), "picture.jpg", int64_t{1} << 24);
  EXPECT_EQ(back.width, picture.width);
  EXPECT_EQ(back.height, picture.height);
  double sum = 0;
  for (size_t i = 0; i < picture.bytes.size(); ++i)
    sum += std::pow(255.0 * back.pixels[i] - picture.bytes[i], 2);
  return std::sqrt(sum / static_cast<double>(picture.bytes.size()));
}

TEST(PictureEncoder, AnotherDecoderReadsIt) {
  EXPECT_LT(error_of(waves(67, 45), JpegQuality::Still), 2.5);
  EXPECT_LT(error_of(waves(67, 45), JpegQuality::Moving), 8);
  EXPECT_LT(error_of(waves(1, 1), JpegQuality::Still), 3);
}

TEST(PictureEncoder, ADraftIsSmaller) {
  const DisplayPicture picture = waves(320, 240);
  EXPECT_LT(encode_jpeg(picture, JpegQuality::Moving).size(),
            encode_jpeg(picture, JpegQuality::Still).size());
}

}  // namespace
}  // namespace lte::infer::view
