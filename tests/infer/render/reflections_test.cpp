// Metal in pictures by the radiance decoder, and its maps beside the traced ones.
#include "lte/pathtrace/incident/reflections.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/incident_map.h"
#include "infer/renderer/reflected_light.h"
#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

scene::Scene metal_room() {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.3f;
  return scene;
}

scene::Camera view_of_the_box() {
  return {"box", {2.6f, 1.4f, 2.6f}, {0.9f, 0.6f, 0.9f}, {0, 1, 0}, 60};
}

RenderSettings settings(Metal metal) {
  RenderSettings out;
  out.width = 24;
  out.height = 16;
  out.metal = metal;
  out.antialias = 0;
  out.spp = 16;
  return out;
}

struct Room {
  explicit Room(const test::TinyModel& tiny) : scene(metal_room()), renderer(scene) {
    const test::TempDir folder;
    test::save_tiny_model(folder / "tiny.safetensors", tiny);
    renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
    const pathtrace::GBuffer hits =
        pathtrace::trace_gbuffer(renderer.bvh(), view_of_the_box(), 24, 16);
    for (int64_t i = 0; i < 24 * 16; ++i) {
      if (hits.instance[static_cast<size_t>(i)] == 1) metal.push_back(i);
    }
  }
  Rgb at(const image::Image& image, int64_t pixel) const {
    return image.rgb(static_cast<int>(pixel % 24), static_cast<int>(pixel / 24));
  }

  scene::Scene scene;
  Renderer renderer;
  std::vector<int64_t> metal;  ///< pixels whose centres see it
};

test::TinyModel even(double radiance) {
  test::TinyModel tiny;
  tiny.radiance_lobes = 4;
  tiny.even_radiance = radiance;
  return tiny;
}

TEST(MetalByNetwork, WithoutBouncedLightIsWhatPathsOfOneReflectionGive) {
  Room room(even(-80));  // softplus is 0: emitters must be there, and there once
  ASSERT_GT(room.metal.size(), 20u);
  const Frame frame = room.renderer.render(view_of_the_box(), settings(Metal::Network));
  const std::vector<pathtrace::PixelRadiance> expected =
      pathtrace::trace_pixels(room.renderer.bvh(), room.renderer.lights(), view_of_the_box(), 24,
                              16, room.metal, {16, 2, 0});
  double light = 0;
  for (size_t i = 0; i < room.metal.size(); ++i) {
    const Rgb got = room.at(frame.color, room.metal[i]),
              wanted = expected[i].emission + expected[i].direct;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(got[c], wanted[c], 1e-4f * (0.1f + wanted[c]));
      light += double{wanted[c]};
    }
  }
  EXPECT_GT(light, 0.1) << "the lamps are seen in the metal";
}

TEST(MetalByNetwork, ReflectsInAFurnaceWhatTheLightSamplerFinds) {
  // Walls of radiance 1 around a rough box: what it reflects is its directional albedo.
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0, 0, 0}, {1, 1, 1});
  const int metal = test::add_metal(&scene, {0.9f, 0.6f, 0.3f}, 0.5f, 0.6f);
  test::add_instance(&scene, test::box_mesh({-3, -3, -3}, {3, 3, 3}, wall, true));
  test::add_instance(&scene,
                     test::box_mesh({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.8f}, metal, false));
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::Camera camera{"c", {2, 1.2f, 1.5f}, {0, 0, 0}, {0, 1, 0}, 30};
  const std::vector<int64_t> pixels = {5 * 12 + 6, 6 * 12 + 5, 7 * 12 + 7};
  const pathtrace::Reflections drawn =
      pathtrace::draw_reflections(bvh, camera, 12, 12, pixels, {64, 16, 3});
  std::vector<Rgb> got(pixels.size());
  for (size_t i = 0; i < drawn.weight.size(); ++i) {
    EXPECT_NEAR(length(drawn.direction[i]), 1, 1e-4f);
    EXPECT_GT(dot(drawn.direction[i], drawn.normal[i / 16]), 0);
    got[static_cast<size_t>(drawn.pixel[i / 16])] += drawn.weight[i] * (1.0f / (64 * 16));
  }
  const auto expected = pathtrace::trace_pixels(bvh, lights, camera, 12, 12, pixels, {4096, 2, 1});
  for (size_t i = 0; i < pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[i][c], expected[i].direct[c], 0.015f);
  }
}

TEST(MetalByNetwork, NeedsARadianceDecoder) {
  Room room(test::TinyModel{});
  try {
    room.renderer.render(view_of_the_box(), settings(Metal::Network));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no radiance decoder"));
  }
}

TEST(IncidentMap, MapsStandSideBySide) {
  std::vector<Rgb> left(16), right(16);
  left[5] = {1, 2, 3};
  right[14] = {4, 5, 6};
  const image::Image out = maps_side_by_side(left, right, 4);
  EXPECT_EQ(out.width, 9);
  EXPECT_EQ(out.height, 4);
  EXPECT_EQ(out.rgb(1, 1), (Rgb{1, 2, 3}));
  EXPECT_EQ(out.rgb(5 + 2, 3), (Rgb{4, 5, 6}));
}

}  // namespace
}  // namespace lte::infer
