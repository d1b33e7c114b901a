// What lands in picture files.
#include "infer/render/frame_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/scene/load_camera.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

/// A frame of two pixels: a surface and the background beside it.
Frame two_pixels() {
  Frame frame;
  for (image::Image* picture : {&frame.color, &frame.albedo, &frame.normal, &frame.emission,
                                &frame.direct, &frame.indirect}) {
    *picture = image::Image(2, 1, 3);
  }
  frame.depth = image::Image(2, 1, 1);
  frame.color.set_rgb(0, 0, {3, 2, 1});
  frame.albedo.set_rgb(0, 0, {0.5f, 0.25f, 0.125f});
  frame.normal.set_rgb(0, 0, {0, -1, 0});
  frame.direct.set_rgb(0, 0, {7, 8, 9});
  frame.indirect.set_rgb(0, 0, {4, 5, 6});
  frame.depth.pixels[0] = 2.5f;
  return frame;
}

TEST(WriteFrame, ExrCarriesTheOutputAndEveryLayer) {
  const test::TempDir folder;
  const Frame frame = two_pixels();
  const auto path = folder / "a.EXR";
  write_frame(path, frame, Output::Full, 100);
  const std::pair<const char*, const image::Image*> layers[] = {
      {"", &frame.color},           {"albedo", &frame.albedo},     {"normal", &frame.normal},
      {"depth", &frame.depth},      {"emission", &frame.emission}, {"direct", &frame.direct},
      {"indirect", &frame.indirect}};
  for (const auto& [name, expected] : layers) {
    const image::Image read = image::read_exr(path, name);
    EXPECT_EQ(read.pixels, expected->pixels) << "layer " << name;
  }
  EXPECT_THROW(image::read_exr(path, "total"), Error) << "a layer that the output did not need";
}

TEST(WriteFrame, ExrIsACameraFile) {
  const test::TempDir folder;
  const scene::Camera camera{"door", {1.1f, 2, 3}, {0, 0.7f, 0}, {0, 0, 1}, 33.3f, true};
  write_frame(folder / "a.exr", two_pixels(), Output::Full, 1, &camera);
  EXPECT_EQ(scene::camera_json(scene::load_camera(folder / "a.exr")), scene::camera_json(camera));
  write_frame(folder / "b.exr", two_pixels(), Output::Full, 1);
  EXPECT_THROW(scene::load_camera(folder / "b.exr"), Error);
}

TEST(WriteFrame, PngExposesLightButNotMaterials) {
  const test::TempDir folder;
  const Frame frame = two_pixels();
  write_frame(folder / "full.png", frame, Output::Full, 0.25f);
  const image::Image full = image::read_png(folder / "full.png");
  EXPECT_NEAR(full.at(0, 0)[0], image::linear_to_srgb(0.75f), 0.5f / 255);
  EXPECT_NEAR(full.at(0, 0)[2], image::linear_to_srgb(0.25f), 0.5f / 255);
  Frame albedo = two_pixels();
  albedo.color = albedo.albedo;
  write_frame(folder / "albedo.png", albedo, Output::Albedo, 0.25f);
  EXPECT_NEAR(image::read_png(folder / "albedo.png").at(0, 0)[0], image::linear_to_srgb(0.5f),
              0.5f / 255);
}

TEST(WriteFrame, PngMapsNormalsAndDepthToTheUnitRange) {
  const test::TempDir folder;
  Frame frame = two_pixels();
  write_frame(folder / "normal.png", frame, Output::Normal, 1);
  const image::Image normal = image::read_png(folder / "normal.png");
  EXPECT_NEAR(normal.at(0, 0)[0], 0.5f, 1.0f / 255);
  EXPECT_EQ(normal.at(0, 0)[1], 0);
  EXPECT_EQ(normal.at(1, 0)[0], 0) << "background stays black";
  frame.color = frame.depth;
  write_frame(folder / "depth.png", frame, Output::Depth, 1);
  const image::Image depth = image::read_png(folder / "depth.png");
  EXPECT_EQ(depth.at(0, 0)[0], 1);
  EXPECT_EQ(depth.at(1, 0)[0], 0);
}

TEST(FrameExposure, IsOneForWhatIsNotLight) {
  Frame frame = two_pixels();
  EXPECT_EQ(frame_exposure(frame, Output::Full), image::auto_exposure(frame.color));
  frame.color.set_rgb(1, 0, {900, 900, 900});  // of the sky
  EXPECT_NEAR(frame_exposure(frame, Output::Full), 0.8 / luminance({3, 2, 1}), 1e-6);
  EXPECT_EQ(frame_exposure(frame, Output::Normal), 1);
}

TEST(WriteFrame, RefusesOtherExtensionsAndMissingFolders) {
  const test::TempDir folder;
  const Frame frame = two_pixels();
  EXPECT_THROW(write_frame(folder / "a.jpg", frame, Output::Full, 1), Error);
  EXPECT_THROW(write_frame(folder / "none/a.exr", frame, Output::Full, 1), Error);
  EXPECT_THROW(write_frame(folder / "none/a.png", frame, Output::Full, 1), Error);
  EXPECT_THAT(folder.names(), testing::IsEmpty());
  EXPECT_TRUE(is_picture_path("x/y.PNG"));
  EXPECT_FALSE(is_picture_path("x/y.png.tmp"));
}

}  // namespace
}  // namespace lte::infer
