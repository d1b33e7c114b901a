// What pictures show in the place of metal.
#include "lte/scene/metal.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/notes.h"
#include "infer/renderer/renderer.h"
#include "tests/infer/fixture.h"
#include "tests/support/captured_log.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The furnished room whose first box is a rough conductor, mixed with a matt surface.
scene::Scene room_with_metal(float metallic) {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = metallic;
  scene.materials[1].roughness = 0.5f;
  return scene;
}

scene::Camera view_of_the_box() {
  return {"box", {2.6f, 1.4f, 2.6f}, {0.9f, 0.6f, 0.9f}, {0, 1, 0}, 60};
}

RenderSettings settings(Output output, Metal metal, int antialias = 0) {
  RenderSettings out;
  out.output = output;
  out.width = 24;
  out.height = 16;
  out.metal = metal;
  out.antialias = antialias;
  out.spp = 16;
  return out;
}

struct Room {
  explicit Room(float metallic) : scene(room_with_metal(metallic)), renderer(scene) {
    const test::TempDir folder;
    test::save_tiny_model(folder / "tiny.safetensors");
    renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
    hits = pathtrace::trace_gbuffer(renderer.bvh(), view_of_the_box(), 24, 16);
  }
  bool is_metal(int x, int y) const { return hits.instance[static_cast<size_t>(y * 24 + x)] == 1; }

  scene::Scene scene;
  Renderer renderer;
  pathtrace::GBuffer hits;
};

TEST(Metal, TracedPixelsAreThoseOfTheReferenceAndOthersStay) {
  Room room(1);
  const scene::Camera camera = view_of_the_box();
  const Frame traced = room.renderer.render(camera, settings(Output::Full, Metal::Trace));
  const Frame diffuse = room.renderer.render(camera, settings(Output::Full, Metal::Diffuse));
  const image::Image reference =
      pathtrace::render_reference(room.renderer.bvh(), room.renderer.lights(), camera, 24, 16,
                                  {16, RenderSettings().max_depth + 1, 0});
  int64_t metal = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      const Rgb got = traced.color.rgb(x, y), expected = reference.rgb(x, y);
      if (!room.is_metal(x, y)) {
        // Irradiance by the network is the same; that by light samples differs in its noise, as
        // fewer pixels ask.
        EXPECT_LT(length(traced.indirect.rgb(x, y) - diffuse.indirect.rgb(x, y)),
                  1e-5f * (1 + length(diffuse.indirect.rgb(x, y))));
        EXPECT_EQ(traced.albedo.rgb(x, y), diffuse.albedo.rgb(x, y));
        continue;
      }
      ++metal;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 1e-4f * (0.1f + expected[c]));
      const Rgb sum =
          traced.emission.rgb(x, y) +
          traced.albedo.rgb(x, y) / kPi * (traced.direct.rgb(x, y) + traced.indirect.rgb(x, y));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], sum[c], 1e-5f * (1 + sum[c]));
    }
  }
  ASSERT_GT(metal, 20);
  EXPECT_EQ(traced.traced_pixels, metal);
  EXPECT_EQ(diffuse.traced_pixels, 0);
  EXPECT_NEAR(traced.metal, static_cast<double>(metal), 1e-3);
  EXPECT_EQ(traced.metal_by_default, 0) << "its roughness is not glTF's default";
}

TEST(Metal, OutputsOfTracedMetalAddUp) {
  Room room(1);
  const scene::Camera camera = view_of_the_box();
  const Frame full = room.renderer.render(camera, settings(Output::Full, Metal::Trace));
  const Frame gi = room.renderer.render(camera, settings(Output::Gi, Metal::Trace));
  const Frame direct = room.renderer.render(camera, settings(Output::Direct, Metal::Trace));
  double direct_sum = 0, full_sum = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      if (!room.is_metal(x, y)) continue;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(gi.color.rgb(x, y)[c] + direct.color.rgb(x, y)[c] + full.emission.rgb(x, y)[c],
                    full.color.rgb(x, y)[c], 1e-4f * (1 + full.color.rgb(x, y)[c]));
      }
      direct_sum += direct.color.rgb(x, y).x;
      full_sum += full.color.rgb(x, y).x;
    }
  }
  EXPECT_GT(direct_sum, 0);
  EXPECT_GT(full_sum, direct_sum);
}

TEST(Metal, BlackLeavesTheMattShareAndIrradianceIsThatOfAnySurface) {
  Room room(0.75f);
  const scene::Camera camera = view_of_the_box();
  const Frame black = room.renderer.render(camera, settings(Output::Full, Metal::Black));
  const Frame diffuse = room.renderer.render(camera, settings(Output::Full, Metal::Diffuse));
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      const float share = room.is_metal(x, y) ? 0.25f : 1.0f;
      EXPECT_NEAR(black.albedo.rgb(x, y).x, share * diffuse.albedo.rgb(x, y).x, 1e-6f);
    }
  }
  const Frame one = room.renderer.render(camera, settings(Output::Irradiance, Metal::Trace));
  const Frame two = room.renderer.render(camera, settings(Output::Irradiance, Metal::Diffuse));
  EXPECT_EQ(one.color.pixels, two.color.pixels);
  EXPECT_EQ(one.traced_pixels, 0);
}

TEST(Metal, EdgesOfMetalAreTracedAsAWhole) {
  Room room(1);
  const Frame frame =
      room.renderer.render(view_of_the_box(), settings(Output::Full, Metal::Trace, 16));
  const int64_t centres = std::count(room.hits.instance.begin(), room.hits.instance.end(), 1);
  EXPECT_GT(frame.traced_pixels, centres);
  EXPECT_LT(frame.traced_pixels, 2 * centres);
  const image::Image reference =
      pathtrace::render_reference(room.renderer.bvh(), room.renderer.lights(), view_of_the_box(),
                                  24, 16, {16, RenderSettings().max_depth + 1, 0});
  int64_t same = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      const Rgb difference = frame.color.rgb(x, y) - reference.rgb(x, y);
      same += length(difference) < 1e-4f * (0.1f + length(reference.rgb(x, y))) ? 1 : 0;
    }
  }
  EXPECT_GE(same, frame.traced_pixels);
}

TEST(Metal, WhatStandsForItIsSaidWithItsShareAndReason) {
  Room room(1);
  room.scene.materials[1].roughness = 1;
  Frame frame = room.renderer.render(view_of_the_box(), settings(Output::Full, Metal::Trace));
  const auto said = [&](Metal metal, LogLevel level) {
    return test::stderr_of(level,
                           [&] { report_metal("room.glb", settings(Output::Full, metal), frame); });
  };
  EXPECT_THAT(said(Metal::Trace, LogLevel::Info),
              AllOf(HasSubstr("room.glb"), HasSubstr("% of the visible surface is metal"),
                    HasSubstr("path-traced"), HasSubstr("16 paths")));
  EXPECT_EQ(said(Metal::Trace, LogLevel::Warning), "");
  EXPECT_THAT(said(Metal::Diffuse, LogLevel::Warning),
              AllOf(HasSubstr("warning"), HasSubstr("--metal trace"),
                    HasSubstr("as glTF has it where a file says nothing")));
  EXPECT_THAT(said(Metal::Black, LogLevel::Warning), HasSubstr("black"));
  frame.metal = 0;
  EXPECT_EQ(said(Metal::Diffuse, LogLevel::Info), "") << "a scene without metal has no line";
}

}  // namespace
}  // namespace lte::infer
