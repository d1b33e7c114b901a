#include "lte/nn/points/surfels.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <torch/types.h>

#include "lte/base/math.h"
#include "lte/nn/model.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

/// A square of points in the plane z = height, spaced evenly over [-1, 1]², that looks along
/// `normal`.
struct Plate {
  double height, normal;
  Rgb sent, emission{};  ///< of the side that it looks to: π radiance
  double metallic = 0, roughness = 0;
  Rgb back{};
};

constexpr int kEdge = 40;

Surfels surfels_of(const std::vector<Plate>& plates) {
  std::vector<float> rows;
  for (const Plate& p : plates) {
    for (int i = 0; i < kEdge * kEdge; ++i) {
      const auto place = [](int at) { return (static_cast<float>(at) + 0.5f) * 2 / kEdge - 1; };
      const Rgb metal = Rgb{0.5f, 0.25f, 1} * static_cast<float>(p.metallic);
      const float z = static_cast<float>(p.height);
      const std::vector<float> row = {place(i % kEdge),
                                      place(i / kEdge),
                                      z,
                                      0,
                                      0,
                                      static_cast<float>(p.normal),
                                      1.6f * 2 / kEdge / std::sqrt(std::numbers::pi_v<float>),
                                      p.sent.x,
                                      p.sent.y,
                                      p.sent.z,
                                      p.back.x,
                                      p.back.y,
                                      p.back.z,
                                      p.emission.x,
                                      p.emission.y,
                                      p.emission.z,
                                      metal.x,
                                      metal.y,
                                      metal.z,
                                      static_cast<float>(p.metallic),
                                      static_cast<float>(p.roughness)};
      rows.insert(rows.end(), row.begin(), row.end());
    }
  }
  return Surfels(torch::tensor(rows).view({-1, Surfels::kColumns}));
}

std::vector<float> look(const Surfels& surfels, const Vec3& from, const Vec3& to) {
  const Vec3 way = normalize(to - from);
  const at::Tensor seen = surfels.see(torch::tensor({{from.x, from.y, from.z}}),
                                      torch::tensor({way.x, way.y, way.z}).view({1, 1, 3}));
  const at::Tensor row = seen.contiguous().view({-1});
  return {row.const_data_ptr<float>(), row.const_data_ptr<float>() + row.numel()};
}

void expect_color(const std::vector<float>& seen, const Rgb& color) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(seen[static_cast<size_t>(kSeenRadiance + c)], color[c], 1e-4) << c;
    EXPECT_NEAR(seen[static_cast<size_t>(kSeenLog + c)], std::log1p(color[c]), 1e-4) << c;
  }
}

TEST(Surfels, ARayMeetsTheNearestPlateThatFacesIt) {
  const Rgb near{0.25f, 0.5f, 0.75f}, far{3, 2, 1};
  const Surfels surfels = surfels_of({{1, -1, near}, {2, -1, far}, {-1, 1, far}});
  const auto up = look(surfels, {0.1f, 0, 0}, {0.3f, 0.2f, 1});
  expect_color(up, near);
  EXPECT_EQ(up[kSeenHit], 1);
  EXPECT_EQ(up[kSeenMetal], 0);
  const float length_to_it = std::sqrt(0.04f + 0.04f + 1);
  EXPECT_NEAR(up[kSeenCosine], 1 / length_to_it, 1e-4);
  const auto farther = look(surfels, {0.1f, 0, -0.5f}, {0.1f, 0, 1});
  EXPECT_NEAR(farther[kSeenDistance] - look(surfels, {0.1f, 0, 0}, {0.1f, 0, 1})[kSeenDistance],
              std::log(1.5), 1e-4);
  expect_color(look(surfels, {0.1f, 0, 1.5f}, {0.1f, 0.1f, 2}), far);
  const auto beside = look(surfels, {0, 0, 0}, {1, 0, 0.01f});
  EXPECT_EQ(beside[kSeenHit], 0);
  expect_color(beside, {});
}

TEST(Surfels, ARayPassesTheInsideOfABodyAndMeetsABackThatIsLit) {
  const Rgb front{1, 1, 1}, beyond{2, 2, 2}, back{0.5f, 0.5f, 0.5f};
  const Plate dark{1, 1, front}, lit{1, 1, front, {}, 0, 0, back};
  expect_color(look(surfels_of({dark, {2, -1, beyond}}), {0, 0, 0}, {0, 0, 1}), beyond);
  expect_color(look(surfels_of({lit, {2, -1, beyond}}), {0, 0, 0}, {0, 0, 1}), back);
}

TEST(Surfels, TheSurfaceThatARayLeavesIsNotInItsWay) {
  const Surfels surfels = surfels_of({{0, 1, {5, 5, 5}}, {1, -1, {1, 2, 3}}});
  expect_color(look(surfels, {0.2f, 0.2f, 0}, {0.5f, 0.2f, 1}), {1, 2, 3});
}

TEST(Surfels, AMirrorShowsWhatLiesBehindTheRayAndLampsInIt) {
  const Rgb color{1, 2, 4}, metal{0.5f, 0.25f, 1}, lamp{10, 10, 10};
  Plate mirror{1, -1, {}};
  mirror.metallic = 1;
  Plate floor{-1, 1, color};
  expect_color(look(surfels_of({mirror, floor}), {0, 0, 0}, {0.1f, 0, 1}), metal * color);
  EXPECT_NEAR(look(surfels_of({mirror, floor}), {0, 0, 0}, {0, 0, 1})[kSeenMetal], 1, 1e-5);
  floor.emission = lamp;
  const Surfels lit = surfels_of({mirror, floor});
  expect_color(look(lit, {0, 0, 0}, {0.1f, 0, 1}), metal * (color + lamp));
  // Emission seen at once is direct light, which is not what rays ask for.
  expect_color(look(lit, {0, 0, 0}, {0.1f, 0, -1}), color);
}

/// The whole way: points of a scene, network space, the scale of light and the decoder's answers.
TEST(Surfels, OfScenePointsSendOutWhatTheDecoderSaysOfThem) {
  ModelConfig config = test::tiny_geometric_config();
  config.light_input = LightInput::Traced;
  config.radiance_lobes = 6;
  PointSet points = test::box_scene(400, 1);
  const int64_t M = points.position.size(0);
  points.gloss = torch::zeros({M, 2});
  points.gloss.select(1, 0).narrow(0, 0, 50).fill_(1);
  LightTransportModel model(config);
  test::randomize(*model, 3);
  model->eval();
  const at::NoGradGuard no_grad;
  const Embedding embedding = model->encode(points);
  ASSERT_TRUE(embedding.surfels.defined());
  const at::Tensor unit = embedding.emission_scale.to(at::kFloat);
  const at::Tensor bounced =
      model->decode(embedding, {points.position, points.normal, points.albedo}) / unit;
  const at::Tensor expected =
      points.albedo * ((points.direct - points.direct_back) / unit + bounced);
  const at::Tensor table = embedding.surfels.table();
  const at::Tensor sent = table.narrow(1, Surfels::kFront, 3);
  EXPECT_EQ(sent.narrow(0, 0, 50).abs().max().item<float>(), 0) << "metal scatters nothing";
  EXPECT_LT(test::relative_difference(sent.narrow(0, 50, M - 50), expected.narrow(0, 50, M - 50)),
            1e-4);
  EXPECT_TRUE(torch::allclose(table.narrow(1, Surfels::kMetal, 3).narrow(0, 0, 50),
                              points.albedo.narrow(0, 0, 50)));
  const at::Tensor place = table.narrow(1, 0, 3) * config.scale + embedding.origin;
  EXPECT_LT((place - points.position).abs().max().item<float>(), 1e-4);
  const at::Tensor radius = table.select(1, Surfels::kRadius) * config.scale;
  EXPECT_LT((radius - 1.6 * (points.area / std::numbers::pi).sqrt()).abs().max().item<float>(),
            1e-5);
}

}  // namespace
}  // namespace lte::nn
