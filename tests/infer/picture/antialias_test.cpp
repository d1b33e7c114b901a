// Anti-aliasing against closed forms of coverage and against pictures of many times the size.
#include "infer/picture/antialias.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

RenderSettings settings(Output output, int width, int height, int antialias) {
  RenderSettings out;
  out.output = output;
  out.width = width;
  out.height = height;
  out.antialias = antialias;
  return out;
}

/// Looks along −z; the picture shows [−1, 1]² of the plane z = −1.
scene::Camera square_camera() { return {"square", {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90}; }

/// Area of the unit square at (x, y) where nx * x + ny * y < d, by clipping (Sutherland-Hodgman).
double clipped_area(double x, double y, double nx, double ny, double d) {
  std::vector<std::pair<double, double>> corners{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}};
  std::vector<std::pair<double, double>> kept;
  const auto side = [&](const std::pair<double, double>& p) {
    return d - nx * p.first - ny * p.second;
  };
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double sa = side(a), sb = side(b);
    if (sa >= 0) kept.push_back(a);
    if ((sa >= 0) == (sb >= 0)) continue;
    const double t = sa / (sa - sb);
    kept.push_back({a.first + t * (b.first - a.first), a.second + t * (b.second - a.second)});
  }
  double area = 0;
  for (size_t i = 0; i < kept.size(); ++i) {
    const auto &a = kept[i], &b = kept[(i + 1) % kept.size()];
    area += a.first * b.second - b.first * a.second;
  }
  return std::abs(area) / 2;
}

/// How far a pixel's emission is from the share of it that a sheet of radiance 1 covers.
struct CoverageError {
  double rms = 0, mean = 0;
  int edges = 0;
  int64_t edge_pixels = 0;  ///< that the picture counts
};

CoverageError coverage_error(double degrees, int size, int hits) {
  // A sheet that ends along a line through (0.013, 0.021): its front faces the camera.
  const double angle = degrees * M_PI / 180;
  const Vec3 along{static_cast<float>(-std::sin(angle)), static_cast<float>(std::cos(angle)), 0};
  const Vec3 away{static_cast<float>(-std::cos(angle)), static_cast<float>(-std::sin(angle)), 0};
  const Vec3 through{0.013f, 0.021f, -1};
  scene::Scene scene;
  const int glow = test::add_material(&scene, {0, 0, 0}, {1, 1, 1});
  test::add_quad(&scene, through - along * 10, along * 20, away * 20, glow);
  Renderer renderer(scene);
  const Frame frame = renderer.render(square_camera(), settings(Output::Albedo, size, size, hits));
  // The edge in pixels: x to the right, y down.
  const double px = (through.x + 1) * size / 2, py = (1 - through.y) * size / 2;
  const double nx = std::cos(angle), ny = -std::sin(angle), d = nx * px + ny * py;
  CoverageError out;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double expected = clipped_area(x, y, nx, ny, d);
      const double error = frame.emission.rgb(x, y).x - expected;
      if (expected < 1e-6 || expected > 1 - 1e-6) {
        EXPECT_NEAR(error, 0, 1e-6) << x << " " << y;
        continue;
      }
      out.rms += error * error;
      out.mean += error;
      ++out.edges;
    }
  }
  out.rms = std::sqrt(out.rms / out.edges);
  out.mean /= out.edges;
  out.edge_pixels = frame.edge_pixels;
  return out;
}

TEST(Antialias, AnEdgeCoversPixelsByItsClosedForm) {
  constexpr int kSize = 40, kHits = 16;
  for (const double degrees : {0.0, 7.0, 30.0, 45.0, 83.0}) {
    const CoverageError error = coverage_error(degrees, kSize, kHits);
    ASSERT_GE(error.edges, kSize - 1) << degrees;
    // Six tenths of what random points leave: their variance is c (1 - c) / N, 1/6 / N on average.
    EXPECT_LT(error.rms, 0.6 / std::sqrt(6.0 * kHits)) << degrees;
    EXPECT_NEAR(error.mean, 0, 0.02) << degrees;
    EXPECT_GE(error.edge_pixels, error.edges - 2) << "pixels in corners have no neighbour beyond";
    EXPECT_LE(error.edge_pixels, 5 * kSize);
  }
}

TEST(Antialias, PixelsAtTheEdgeOfALampHaveHundredHitsForItsLight) {
  // 160,000 pixels have up to 40,000 of them, of which some 500 pixels with a part of the lamp get
  // 70 or more.
  for (const double degrees : {7.0, 30.0, 45.0, 83.0}) {
    const CoverageError error = coverage_error(degrees, 400, 16);
    EXPECT_LT(error.rms, 0.6 / std::sqrt(6.0 * 70)) << degrees;
    EXPECT_NEAR(error.mean, 0, 0.004) << degrees;  // at 45° all pixels of the edge lie alike
  }
}

/// Pixels that no edge touches.
std::vector<size_t> interior(const Renderer& renderer, const scene::Camera& camera, int width,
                             int height) {
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(renderer.bvh(), camera, width, height);
  const std::vector<int32_t> edges =
      find_edges({hits, {width, height, 0, height}, pathtrace::pixel_size(camera, height)});
  std::vector<size_t> out;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    if (!std::binary_search(edges.begin(), edges.end(), static_cast<int32_t>(i))) out.push_back(i);
  }
  return out;
}

TEST(Antialias, PixelsAwayFromEdgesKeepEveryBit) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  for (const Output output : {Output::Full, Output::Gi, Output::Irradiance, Output::Albedo}) {
    const Frame plain = renderer.render(camera, settings(output, 48, 36, 0));
    const Frame smooth = renderer.render(camera, settings(output, 48, 36, 8));
    EXPECT_EQ(plain.edge_pixels, 0);
    const std::vector<size_t> inside = interior(renderer, camera, 48, 36);
    ASSERT_GT(inside.size(), 48u * 36 / 2);
    ASSERT_EQ(inside.size() + static_cast<size_t>(smooth.edge_pixels), 48u * 36);
    int64_t changed = 0;
    for (size_t i = 0; i < 3u * 48 * 36; ++i)
      changed += plain.color.pixels[i] != smooth.color.pixels[i] ? 1 : 0;
    EXPECT_GT(changed, 0) << enum_name(output);
    for (const size_t i : inside) {
      for (size_t c = 3 * i; c < 3 * i + 3; ++c)
        ASSERT_EQ(plain.color.pixels[c], smooth.color.pixels[c]) << enum_name(output) << " " << i;
    }
  }
}

TEST(Antialias, LayersAddUpToThePictureInEveryPixel) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  renderer.embed(runtime::Network(folder / "tiny.safetensors"), {});
  const Frame frame =
      renderer.render(pathtrace::auto_camera(renderer.bvh()), settings(Output::Full, 48, 36, 8));
  for (size_t i = 0; i < frame.color.pixels.size(); ++i) {
    const float sum =
        frame.emission.pixels[i] +
        frame.albedo.pixels[i] / kPi * (frame.direct.pixels[i] + frame.indirect.pixels[i]);
    EXPECT_NEAR(frame.color.pixels[i], sum, 1e-5f * (1 + sum));
  }
}

/// Means over squares of `factor` pixels.
image::Image shrunk(const image::Image& large, int factor) {
  image::Image out(large.width / factor, large.height / factor, 3);
  const float share = 1.0f / static_cast<float>(factor * factor);
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) {
      const Rgb value = large.rgb(x, y) * share;
      out.set_rgb(x / factor, y / factor, out.rgb(x / factor, y / factor) + value);
    }
  }
  return out;
}

double mean_square(const image::Image& a, const image::Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    sum += (double{a.pixels[i]} - b.pixels[i]) * (double{a.pixels[i]} - b.pixels[i]);
  return sum / static_cast<double>(a.pixels.size());
}

TEST(Antialias, ErrorAgainstAPictureOfEightTimesTheSizeFalls) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  const image::Image reference =
      shrunk(renderer.render(camera, settings(Output::Direct, 48 * 8, 36 * 8, 0)).color, 8);
  RenderSettings wanted = settings(Output::Direct, 48, 36, 0);
  wanted.direct_samples = 1024;
  const double plain = mean_square(renderer.render(camera, wanted).color, reference);
  wanted.antialias = 16;
  const double smooth = mean_square(renderer.render(camera, wanted).color, reference);
  EXPECT_LT(smooth, 0.15 * plain);
  EXPECT_GT(smooth, 0);
}

TEST(Antialias, FewPointsAreAskedBeyondThoseOfPixels) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  const int64_t plain = renderer.render(camera, settings(Output::Direct, 96, 72, 0)).queries;
  const Frame smooth = renderer.render(camera, settings(Output::Direct, 96, 72, 16));
  EXPECT_LT(smooth.queries - plain, smooth.edge_pixels / 10);
}

/// Hits in each column of pixels of two halves that meet at 0.3 of column 20: in the pixels of row
/// 20, 0 for those that no edge touches.
std::vector<int> hits_by_column(const Rgb& emission) {
  constexpr int kSize = 40;
  scene::Scene scene;
  const int left = test::add_material(&scene, {0.8f, 0.8f, 0.8f}, emission),
            right = test::add_material(&scene, {0.1f, 0.1f, 0.1f});
  const float meet = 2 * 20.3f / kSize - 1;
  test::add_quad(&scene, {meet, -10, -1}, {0, 20, 0}, {-20, 0, 0}, left);
  test::add_quad(&scene, {meet, -10, -1}, {20, 0, 0}, {0, 20, 0}, right);
  const pathtrace::Bvh bvh(scene);
  const scene::Camera camera = square_camera();
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, kSize, kSize);
  const EdgeView view{hits, {kSize, kSize, 0, kSize}, pathtrace::pixel_size(camera, kSize)};
  const SubHits sub = trace_sub_hits(bvh, camera, view, find_edges(view), 8);
  std::vector<int> out(kSize);
  for (size_t entry = 0; entry < sub.pixel.size(); ++entry) {
    int count = 0;
    sub.each(entry, [&](size_t s) {
      ++count;
      EXPECT_EQ(sub.hits.mask[s], 1);
      EXPECT_NEAR(sub.hits.depth[s], 1, 1e-5);
      const auto column = static_cast<int>(std::floor((sub.hits.position[s].x + 1) * kSize / 2));
      EXPECT_EQ(column, sub.pixel[entry] % kSize);
    });
    EXPECT_EQ(count, sub.count(entry));
    if (sub.pixel[entry] / kSize == 20) out[static_cast<size_t>(sub.pixel[entry] % kSize)] = count;
  }
  return out;
}

TEST(Antialias, MoreHitsOnlyWhereTheFirstSeeAnEdge) {
  std::vector<int> expected(40);
  expected[20] = 8;
  expected[19] = 4;  // whole, but its neighbour's centre sees the other half
  EXPECT_EQ(hits_by_column({}), expected);
  expected[19] = 8;  // beside a lamp, the smallest part of which counts
  EXPECT_EQ(hits_by_column({10, 10, 10}), expected);
}

TEST(Antialias, BandsMeetWithoutASeam) {
  // Higher than a band, with edges on every row.
  scene::Scene scene;
  const int glow = test::add_material(&scene, {0, 0, 0}, {1, 1, 1});
  test::add_quad(&scene, {0.013f, -10, -1}, {0, 20, 0}, {-20, 0, 0}, glow);
  Renderer renderer(scene);
  constexpr int kSize = 600;
  const Frame frame = renderer.render(square_camera(), settings(Output::Albedo, kSize, kSize, 4));
  EXPECT_GE(frame.edge_pixels, 2 * kSize);
  EXPECT_LE(frame.edge_pixels, 2 * kSize + 4);
  const auto covered = static_cast<int>(std::floor(1.013 * kSize / 2));
  for (int y = 0; y < kSize; ++y) {
    EXPECT_EQ(frame.emission.rgb(covered - 1, y).x, 1);
    EXPECT_NEAR(frame.emission.rgb(covered, y).x, 1.013 * kSize / 2 - covered, 0.25);
    EXPECT_EQ(frame.emission.rgb(covered + 1, y).x, 0);
  }
}

}  // namespace
}  // namespace lte::infer
