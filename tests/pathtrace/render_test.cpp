#include "lte/pathtrace/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;
using testing::HasSubstr;
using testing::ThrowsMessage;

scene::Camera camera_at(const Vec3& origin, const Vec3& target, float vfov = 60) {
  scene::Camera camera;
  camera.name = "test";
  camera.origin = origin;
  camera.target = target;
  camera.vfov = vfov;
  return camera;
}

TEST(GBuffer, HoldsWhatThePixelCentresSee) {
  scene::Scene scene;
  // z = −3 plane that faces the camera on the left and looks away on the right; nothing above y =
  // 0.
  const int left = add_material(&scene, {0.2f, 0.4f, 0.6f}, {7, 8, 9});
  const int right = add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  add_quad(&scene, {-50, -50, -3}, {50, 0, 0}, {0, 50, 0}, left);
  add_quad(&scene, {0, -50, -3}, {0, 50, 0}, {50, 0, 0}, right);
  const Bvh bvh(scene);
  constexpr int kWidth = 21,
                kHeight = 10;  // no multiple of the packet; no pixel centre on the seams
  const scene::Camera camera = camera_at({0.01f, 0, 0}, {0.01f, 0, -1});
  const GBuffer g = trace_gbuffer(bvh, camera, kWidth, kHeight);
  EXPECT_EQ(g.width, kWidth);
  EXPECT_EQ(g.height, kHeight);
  const double slope = 2 * std::tan(kPi / 6) / kHeight;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto i = static_cast<size_t>(y) * kWidth + static_cast<size_t>(x);
      ASSERT_EQ(g.mask[i], y >= kHeight / 2 ? 1 : 0);
      if (y < kHeight / 2) {
        EXPECT_TRUE(std::isinf(g.depth[i]));
        EXPECT_EQ(g.albedo[i], (Rgb{0, 0, 0}));
        continue;
      }
      EXPECT_NEAR(g.position[i].x, 0.01 + 3 * slope * (x + 0.5 - kWidth / 2.0), 1e-4);
      EXPECT_NEAR(g.position[i].y, -3 * slope * (y + 0.5 - kHeight / 2.0), 1e-4);
      EXPECT_FLOAT_EQ(g.position[i].z, -3);
      EXPECT_NEAR(g.depth[i], 3, 1e-5) << "along the axis, not along the ray";
      EXPECT_EQ(g.normal[i], (Vec3{0, 0, 1})) << "faces the camera on both halves";
      const bool is_left = g.position[i].x < 0;
      EXPECT_EQ(g.albedo[i].x, is_left ? 0.2f : 0.5f);
      EXPECT_EQ(g.emission[i].x, is_left ? 7 : 0) << "the right half shows its back";
    }
  }
}

TEST(GBuffer, AgreesWithSingleRays) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const scene::Camera camera = camera_at({3.7f, 1.5f, 2.7f}, {1, 0.8f, 1});
  const GBuffer g = trace_gbuffer(bvh, camera, 33, 17);
  for (int i = 0; i < 33 * 17; ++i) {
    const int column = i % 33, row = i / 33;
    const Vec3 direction = camera.direction((static_cast<float>(column) + 0.5f) / 33,
                                            (static_cast<float>(row) + 0.5f) / 17, 33.0f / 17);
    const Hit hit = bvh.intersect({camera.origin, direction});
    ASSERT_TRUE(hit.valid());
    const Vec3 expected = camera.origin + direction * hit.t;
    EXPECT_LT(length(g.position[static_cast<size_t>(i)] - expected), 1e-4f);
    EXPECT_LT(dot(g.normal[static_cast<size_t>(i)], direction), 0);
  }
}

TEST(RenderReference, FurnaceHasOneRadianceEverywhere) {
  constexpr float kAlbedo = 0.5f;
  scene::Scene scene;
  const int material = add_material(&scene, {kAlbedo, kAlbedo, kAlbedo}, {2, 1, 0.5f});
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, material, true));
  const Bvh bvh(scene);
  const Lights lights(scene);
  for (const int depth : {1, 2, 6}) {
    RenderOptions options;
    options.max_depth = depth;
    options.spp = 256;
    const auto image =
        render_reference(bvh, lights, camera_at({0.3f, 0.2f, 0.1f}, {0, 0, -1}), 6, 4, options);
    const double expected = 2 * test::geometric_sum(kAlbedo, depth);
    double mean = 0;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 6; ++x) {
        mean += image.rgb(x, y).x / 24;
        EXPECT_NEAR(image.rgb(x, y).x, expected, 0.1 * expected);
        EXPECT_FLOAT_EQ(image.rgb(x, y).x, image.rgb(x, y).y * 2);
      }
    }
    EXPECT_NEAR(mean, expected, 0.01 * expected);
  }
}

/// A pixel's radiance at depth d + 1 is emission + albedo / π times irradiance at depth d: one
/// transport, two ways in.
TEST(RenderReference, IsEmissionPlusReflectedIrradiance) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  // So narrow a view that a pixel is a point.
  const scene::Camera camera = camera_at({3.7f, 1.5f, 2.7f}, {1.7f, 0, 1.9f}, 0.01f);
  RenderOptions options;
  options.spp = 1 << 15;
  const auto image = render_reference(bvh, lights, camera, 1, 1, options);
  const GBuffer g = trace_gbuffer(bvh, camera, 1, 1);
  IrradianceOptions irradiance;
  irradiance.rays = 1 << 15;
  const Irradiance e = estimate_irradiance(bvh, lights, g.position, g.normal, irradiance);
  const Rgb expected = g.emission[0] + g.albedo[0] * e.total(0) * (1 / kPi);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.rgb(0, 0)[c], expected[c], 0.02 * expected[c]);
}

TEST(TracePixels, AreThePixelsOfTheReferenceByTheirBounces) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const scene::Camera camera = camera_at({3.7f, 1.5f, 2.7f}, {1, 1.2f, 1}, 80);
  RenderOptions options;
  options.spp = 8;
  const auto whole = render_reference(bvh, lights, camera, 24, 16, options);
  options.max_depth = 1;
  const auto emitted = render_reference(bvh, lights, camera, 24, 16, options);
  options.max_depth = 2;
  const auto once = render_reference(bvh, lights, camera, 24, 16, options);
  options.max_depth = RenderOptions().max_depth;
  std::vector<int64_t> pixels;  // more than a thread takes at once, in no order
  for (int64_t i = 0; i < 24 * 16; ++i) pixels.push_back(i * 7 % (24 * 16));
  const std::vector<PixelRadiance> parts =
      trace_pixels(bvh, lights, camera, 24, 16, pixels, options);
  double sums[3] = {0, 0, 0};
  for (size_t i = 0; i < pixels.size(); ++i) {
    const int x = static_cast<int>(pixels[i] % 24), y = static_cast<int>(pixels[i] / 24);
    EXPECT_EQ(parts[i].emission + parts[i].direct + parts[i].indirect, whole.rgb(x, y));
    EXPECT_EQ(parts[i].emission, emitted.rgb(x, y));
    const Rgb seen = once.rgb(x, y), split = parts[i].emission + parts[i].direct;
    EXPECT_LT(length(seen - split), 1e-4f * (1 + length(seen)));
    sums[0] += parts[i].emission.x;
    sums[1] += parts[i].direct.x;
    sums[2] += parts[i].indirect.x;
  }
  for (const double sum : sums) EXPECT_GT(sum, 0);
}

TEST(TracePixels, CallsGoOnInOnePointSet) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const scene::Camera camera = camera_at({3.7f, 1.5f, 2.7f}, {1, 1.2f, 1}, 80);
  const std::vector<int64_t> pixels{0, 3, 200, 383};
  RenderOptions options;
  options.spp = 64;
  const auto trace = [&] { return trace_pixels(bvh, lights, camera, 24, 16, pixels, options); };
  const std::vector<PixelRadiance> whole = trace();
  options.in_all = options.spp;
  options.spp = 8;
  std::vector<Rgb> sums(pixels.size());
  for (; options.had < options.in_all; options.had += options.spp) {
    const std::vector<PixelRadiance> part = trace();
    for (size_t i = 0; i < sums.size(); ++i)
      sums[i] += (part[i].emission + part[i].direct + part[i].indirect) * 0.125f;
  }
  for (size_t i = 0; i < sums.size(); ++i) {
    const Rgb wanted = whole[i].emission + whole[i].direct + whole[i].indirect;
    EXPECT_LT(length(sums[i] - wanted), 1e-5f * length(wanted)) << "pixel " << pixels[i];
  }
  options.had = -1;
  EXPECT_THROW(trace(), Error);
}

TEST(RenderReference, DependsNotOnThreads) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  RenderOptions options;
  options.spp = 4;
  const scene::Camera camera = camera_at({3.7f, 1.5f, 2.7f}, {1, 0.8f, 1});
  set_num_threads(1);
  const auto one = render_reference(bvh, lights, camera, 24, 16, options);
  set_num_threads(3);
  EXPECT_EQ(one.pixels, render_reference(bvh, lights, camera, 24, 16, options).pixels);
  set_num_threads(0);
}

TEST(Images, RefuseEmptySizesAndDegenerateCameras) {
  const scene::Scene scene = test::furnished_room();
  const Bvh bvh(scene);
  const Lights lights(scene);
  const auto message = [](const std::string& text) {
    return ThrowsMessage<Error>(HasSubstr(text));
  };
  const scene::Camera good = camera_at({1, 1, 1}, {2, 1, 1});
  EXPECT_THAT([&] { trace_gbuffer(bvh, good, 0, 4); }, message("0x4"));
  EXPECT_THAT([&] { render_reference(bvh, lights, good, 4, -1, {}); }, message("4x-1"));
  EXPECT_THAT(
      [&] {
        trace_gbuffer(bvh, camera_at({1, 1, 1}, {1, 1, 1}), 4, 4);
      },
      message("origin and target"));
  EXPECT_THAT([&] { trace_gbuffer(bvh, camera_at({1, 1, 1}, {1, 2, 1}), 4, 4); }, message("up"));
  EXPECT_THAT(
      [&] {
        trace_gbuffer(bvh, camera_at({1, 1, 1}, {2, 1, 1}, 180), 4, 4);
      },
      message("vfov"));
  EXPECT_THAT(
      [&] {
        trace_gbuffer(bvh, camera_at({NAN, 1, 1}, {2, 1, 1}), 4, 4);
      },
      message("not finite"));
  RenderOptions options;
  options.spp = 0;
  EXPECT_THAT([&] { render_reference(bvh, lights, good, 4, 4, options); }, message("spp"));
}

}  // namespace
}  // namespace lte::pathtrace
