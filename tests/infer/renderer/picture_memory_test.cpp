#include "infer/renderer/picture_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/process_memory.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

RenderSettings settings(int width, int height, Mode mode = Mode::Neural, bool layers = true) {
  RenderSettings out;
  out.width = width;
  out.height = height;
  out.mode = mode;
  out.layers = layers;
  return out;
}

TEST(PictureMemory, WhatDoesNotFitIsRefusedInOneLineForEveryMode) {
  for (const Mode mode : {Mode::Neural, Mode::Reference}) {
    for (const bool layers : {true, false}) {
      const RenderSettings huge = settings(16'000, 16'000, mode, layers);
      const auto said = AllOf(HasSubstr("16000x16000"), HasSubstr("GiB"),
                              HasSubstr("take a smaller one"), testing::Not(HasSubstr("\n")));
      EXPECT_THAT([&] { check_picture_fits(huge, 8192); },
                  ThrowsMessage<runtime::NotEnoughMemory>(said));
      EXPECT_THAT([&] { check_picture_fits(huge, runtime::MemoryLimit(2048)); },
                  ThrowsMessage<runtime::NotEnoughMemory>(AllOf(said, HasSubstr("limit"))));
    }
  }
  EXPECT_THAT([&] { check_picture_fits(settings(20'000, 20'000, Mode::Neural, false), 1e9); },
              ThrowsMessage<Error>(HasSubstr("pixels of a PNG")));
  EXPECT_NO_THROW(check_picture_fits(settings(512, 512), 8192));
  EXPECT_NO_THROW(check_picture_fits(settings(512, 512), runtime::MemoryLimit()));
}

TEST(PictureMemory, GrowsByLayersAndPixelsAlone) {
  const double large = picture_mb(settings(4096, 4096)), twice = picture_mb(settings(4096, 8192));
  EXPECT_NEAR(twice / large, 2, 0.15) << "a band's work does not grow with the picture";
  EXPECT_LT(picture_mb(settings(4096, 4096, Mode::Neural, false)), 0.5 * large);
  EXPECT_LE(picture_mb(settings(4096, 4096, Mode::Reference)), large);
  EXPECT_LT(picture_mb(settings(24, 16)), 1);
  RenderSettings denoised = settings(4096, 4096);
  denoised.denoise = Denoise::On;
  EXPECT_GT(picture_mb(denoised), 4096 * 4096 * 100.0 / (1 << 20));
  RenderSettings gathered = denoised;
  gathered.indirect = Indirect::Gather;
  EXPECT_GT(picture_mb(gathered), picture_mb(denoised) + 4096 * 4096 * 50.0 / (1 << 20));
  denoised.output = Output::Depth;
  const double noisy_depth = picture_mb(denoised);
  denoised.denoise = Denoise::Off;
  EXPECT_EQ(picture_mb(denoised), noisy_depth);
}

}  // namespace
}  // namespace lte::infer
