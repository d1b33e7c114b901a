// Means over halves of noisy samples, and their correction by others, against the light they are
// of.
#include "lte/bake/estimate.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "tests/support/scenes.h"

namespace lte::bake {
namespace {

constexpr int kEdge = 128;
constexpr int kPaths = 16;
constexpr double kLight = 1;

/// Texels of a square metre.
TexelGraph square_graph() {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, test::add_material(&scene, {1, 1, 1}));
  const pathtrace::Bvh bvh(scene);
  std::vector<Vec3> position, normal(size_t{kEdge} * kEdge, Vec3{0, 1, 0});
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x)
      position.push_back(
          {(static_cast<float>(x) + 0.5f) / kEdge, 0, (static_cast<float>(y) + 0.5f) / kEdge});
  const std::vector<float> edge(position.size(), 1.0f / kEdge);
  return {bvh, {position, normal, edge, std::vector<uint8_t>(position.size())}};
}

/// Pairs of texels that nothing else is near.
TexelGraph pairs_graph() {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, test::add_material(&scene, {1, 1, 1}));
  const pathtrace::Bvh bvh(scene);
  std::vector<Vec3> position, normal(100, Vec3{0, 1, 0});
  for (int pair = 0; pair < 50; ++pair) {
    const float x = static_cast<float>(pair) / 50;
    position.insert(position.end(), {{x, 0, 0}, {x + 0.005f, 0, 0}});
  }
  const std::vector<float> edge(position.size(), 0.005f);
  return {bvh, {position, normal, edge, std::vector<uint8_t>(position.size())}};
}

/// Even light by kPaths paths a texel and half, of which one in `rarity` finds a lamp: the rarer,
/// the brighter it is.
Halves paths(double rarity, uint64_t seed) {
  Halves out;
  Rng rng(seed, 1);
  for (std::vector<Rgb>& half : out) {
    for (int i = 0; i < kEdge * kEdge; ++i) {
      int found = 0;
      for (int k = 0; k < kPaths; ++k) found += double{rng.uniform()} * rarity < 1 ? 1 : 0;
      const auto light = static_cast<float>(kLight * rarity * found / kPaths);
      half.push_back({light, light, light});
    }
  }
  return out;
}

Halves even(float light) {
  Halves out;
  out.fill(std::vector<Rgb>(size_t{kEdge} * kEdge, Rgb{light, light, light}));
  return out;
}

/// Of the mean of halves; root mean square.
double error(const Halves& light) {
  double sum = 0;
  for (size_t i = 0; i < light[0].size(); ++i)
    sum += std::pow(double{light[0][i].y + light[1][i].y} / 2 - kLight, 2);
  return std::sqrt(sum / static_cast<double>(light[0].size()));
}

TEST(Estimate, RarePathsDoNotSpoilGatheredLight) {
  const TexelGraph graph = square_graph();
  for (const double rarity : {3.0, 30.0, 300.0}) {
    const Halves found = paths(rarity, 5);
    const Halves wide{graph.spread(found[0], 24), graph.spread(found[1], 24)};
    EXPECT_LT(error(correct(graph, even(1), found)), 0.4 * error(wide)) << rarity;
  }
}

TEST(Estimate, PathsCorrectGatheredLight) {
  const TexelGraph graph = square_graph();
  for (const float wrong : {0.6f, 0.8f, 1.4f}) {
    const double before = std::abs(1 - double{wrong});
    EXPECT_LT(error(correct(graph, even(wrong), paths(3, 7))), 0.5 * before) << wrong;
  }
}

TEST(Estimate, WhatADenoiserLosesComesBack) {
  const TexelGraph graph = square_graph();
  const Halves found = paths(3, 9);
  const double without = error(smooth(graph, found));
  // A good one is believed; one that loses a fifth of the light is not.
  const auto truth = [](const std::vector<Rgb>& light) {
    return std::vector<Rgb>(light.size(), Rgb{1, 1, 1});
  };
  EXPECT_LT(error(smooth(graph, found, truth)), 0.7 * without);
  const auto dim = [&](const std::vector<Rgb>& light) {
    std::vector<Rgb> out = graph.spread(light, 24);
    for (Rgb& value : out) value *= 0.8f;
    return out;
  };
  EXPECT_LT(error(smooth(graph, found, dim)), 0.05) << "of 0.2";
}

TEST(Estimate, ADarkEdgeOfASurfaceStaysDark) {
  // Light that falls off towards an end, where means over neighbours lean inwards.
  const TexelGraph graph = square_graph();
  Halves found = paths(2, 13);
  const auto light = [](size_t i) {
    return std::min(1.0f, (static_cast<float>(i % kEdge) + 0.5f) / 16);
  };
  for (std::vector<Rgb>& half : found)
    for (size_t i = 0; i < half.size(); ++i) half[i] *= light(i);
  const Halves out = smooth(graph, found);
  double edge = 0, wide = 0;
  const Halves means{graph.spread(found[0], 24), graph.spread(found[1], 24)};
  for (size_t i = 0; i < out[0].size(); i += kEdge) {
    edge += double{out[0][i].y + out[1][i].y} / 2 / kEdge;
    wide += double{means[0][i].y + means[1][i].y} / 2 / kEdge;
  }
  EXPECT_NEAR(edge, double{light(0)}, 0.25 * (wide - double{light(0)}));
}

TEST(Estimate, ADenoiserOfPathsCorrectsGatheredLight) {
  const TexelGraph graph = square_graph();
  const auto denoise = [&](const std::vector<Rgb>& light) { return graph.spread(light, 24); };
  for (const float wrong : {0.6f, 1.4f})
    EXPECT_LT(error(correct(graph, even(wrong), paths(3, 7), denoise)), 0.15) << wrong << " of 1";
}

TEST(Estimate, ARareBrightRayIsNoLightOfFewTexels) {
  const TexelGraph graph = pairs_graph();
  for (size_t i = 0; i < graph.size(); ++i) ASSERT_EQ(graph.neighbours(i).size(), 1u);
  Halves samples;
  samples.fill(std::vector<Rgb>(graph.size(), Rgb{1, 1, 1}));
  samples[0][40] = Rgb{80, 80, 80};
  const Halves light = smooth(graph, samples);
  for (size_t i = 0; i < graph.size(); ++i)
    EXPECT_NEAR(double{light[0][i].y + light[1][i].y} / 2, 1, 2) << i;
  // What both halves find is there.
  samples[1][40] = samples[0][40];
  const Halves bright = smooth(graph, samples);
  EXPECT_NEAR(double{bright[0][40].y + bright[1][40].y} / 2, 80, 1);
}

TEST(Estimate, RareBrightRaysOfManyTexelsKeepTheirLight) {
  const TexelGraph graph = square_graph();
  const Halves found = paths(300, 11);
  const auto mean = [](const Halves& light) {
    double sum = 0;
    for (const std::vector<Rgb>& half : light)
      for (const Rgb& value : half) sum += double{value.y} / 2;
    return sum / static_cast<double>(light[0].size());
  };
  EXPECT_NEAR(mean(smooth(graph, found)), mean(found), 0.04);
}

}  // namespace
}  // namespace lte::bake
