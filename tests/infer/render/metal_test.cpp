// What is said of metal in a picture.
#include "lte/scene/metal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/notes.h"
#include "infer/renderer/quality.h"
#include "infer/renderer/renderer.h"
#include "tests/infer/fixture.h"
#include "tests/support/captured_log.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Metal, IsSaidWithItsShareAndReason) {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 1;
  Renderer renderer(scene);
  renderer.make_cache(Method::Gather, {.records = 256});
  RenderSettings settings;
  settings.width = 24;
  settings.height = 16;
  settings.passes = 1;
  settings.denoise = false;
  Frame frame =
      renderer.render({"box", {2.6f, 1.4f, 2.6f}, {0.9f, 0.6f, 0.9f}, {0, 1, 0}, 60}, settings);
  const auto said = [&](LogLevel level) {
    return test::stderr_of(level, [&] { report_metal("room.glb", settings, frame); });
  };
  EXPECT_THAT(
      said(LogLevel::Info),
      AllOf(HasSubstr("room.glb"), HasSubstr("% of the visible surface is metal"),
            HasSubstr("as glTF has it where a file says nothing"), HasSubstr("path-traced there")));
  EXPECT_EQ(said(LogLevel::Warning), "");
  settings.output = Output::Depth;
  EXPECT_EQ(said(LogLevel::Info), "") << "no light is shown";
  settings.output = Output::Full;
  frame.metal = 0;
  EXPECT_EQ(said(LogLevel::Info), "") << "a scene without metal has no line";
}

TEST(Renderer, WhereAllIsMetalThereIsNothingToCache) {
  scene::Scene scene = test::furnished_room();
  RenderSettings settings;
  EXPECT_TRUE(Renderer(scene).needs_cache(settings));
  for (scene::Material& material : scene.materials) material.metallic = 1;
  Renderer renderer(scene);
  EXPECT_FALSE(renderer.needs_cache(settings));
  settings.output = Output::Irradiance;  // which takes metal for matt
  EXPECT_TRUE(renderer.needs_cache(settings));
  settings = with_quality(Quality::Draft, {});
  settings.width = settings.height = 8;
  const Frame frame = renderer.render({"", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70}, settings);
  EXPECT_EQ(frame.metal_pixels, 64);
}

}  // namespace
}  // namespace lte::infer
