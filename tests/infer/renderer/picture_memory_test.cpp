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

/// Pictures are made in strips, so that the work does not grow with them.
TEST(PictureMemory, ADraftIn4KTakesLessThanOneGibibyte) {
  RenderSettings draft = settings(3840, 2160, Mode::Neural, false);
  draft.indirect = Indirect::Gather;
  draft.denoise = Denoise::Auto;
  draft.gather.step = 4;
  draft.gather.direct = true;
  const double once = picture_mb(draft);
  EXPECT_LT(once, 1024);
  draft.height *= 2;
  EXPECT_LT(picture_mb(draft), once + 3840 * 2160 * 60.0 / (1 << 20)) << "by the frame alone";
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
  RenderSettings gathered = settings(1024, 1024, Mode::Neural, false);
  const double plain = picture_mb(gathered);
  gathered.indirect = Indirect::Gather;
  const double in_one_strip = picture_mb(gathered);
  EXPECT_GT(in_one_strip, plain + 1024 * 1024 * 200.0 / (1 << 20));
  gathered.keep_light = true;
  EXPECT_GT(picture_mb(gathered), in_one_strip) << "kept light";
  denoised.output = Output::Depth;
  denoised.output = Output::Depth;
  const double noisy_depth = picture_mb(denoised);
  denoised.denoise = Denoise::Off;
  EXPECT_EQ(picture_mb(denoised), noisy_depth);
}

}  // namespace
}  // namespace lte::infer
