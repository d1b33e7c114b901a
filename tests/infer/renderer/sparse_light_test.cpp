// Sparse answers in pictures of a furnished room.
#include "infer/renderer/sparse_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

/// Smooth over a room, and another on every orientation, so that what leaks is seen.
Rgb smooth(const Vec3& p, const Vec3& n) {
  const float e = 10 + std::sin(p.x) + std::cos(1.3f * p.z) + 0.5f * p.y;
  return {e + 4 * n.x, e + 4 * n.y, e + 4 * n.z};
}

std::vector<Rgb> answer_smoothly(std::span<const gi::Query> queries) {
  std::vector<Rgb> out;
  for (const gi::Query& query : queries) out.push_back(smooth(query.position, query.normal));
  return out;
}

class SparseLightTest : public testing::Test {
 protected:
  PictureBand band(int first, int last, int antialias) const {
    return PictureBand(renderer_.bvh(), camera_, {160, 120, first, last}, {antialias});
  }
  scene::Scene scene_ = test::furnished_room();
  Renderer renderer_{scene_};
  scene::Camera camera_ = pathtrace::auto_camera(renderer_.bvh());
};

TEST_F(SparseLightTest, EveryQueryHasTheLightOfItsSurface) {
  for (const auto& [first, last, antialias] : {std::tuple(0, 120, 0), {0, 120, 8}, {48, 104, 8}}) {
    const PictureBand rows = band(first, last, antialias);
    const SparseLight light = light_sparsely(rows, {}, answer_smoothly);
    const QuerySet& queries = rows.queries();
    ASSERT_EQ(light.irradiance.size(), queries.position.size());
    EXPECT_LT(light.answers, queries.size() / 2);
    double sum = 0;
    for (size_t i = 0; i < queries.position.size(); ++i) {
      const Rgb truth = smooth(queries.position[i], queries.normal[i]);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.irradiance[i][c], truth[c], 0.6f);
      sum += std::abs(double{light.irradiance[i].x} - truth.x);
    }
    EXPECT_LT(sum / static_cast<double>(queries.size()), 0.02);
  }
}

/// A wall behind slats that are thinner than a pixel, each in a plane of its own.
scene::Scene slats() {
  scene::Scene scene;
  const int matt = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_quad(&scene, {-4, -4, -3}, {8, 0, 0}, {0, 8, 0}, matt);
  for (int k = 0; k < 60; ++k) {
    const auto i = static_cast<float>(k);
    test::add_quad(&scene, {-1, 0.021f * i - 0.6f, -2.5f + 0.08f * static_cast<float>(k % 12)},
                   {2, 0.05f, 0}, {0, 0.012f, 0}, matt);
  }
  return scene;
}

TEST(SparseLight, QueriesOfAntialiasingLieInPixelsAtEdgesAndGetTheLightOfTheirSurface) {
  const scene::Scene scene = slats();
  const pathtrace::Bvh bvh(scene);
  const scene::Camera camera{"ahead", {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90};
  const PictureBand rows(bvh, camera, {160, 120, 48, 104}, {8});
  const std::vector<PictureBand::ExtraQuery> extras = rows.extra_queries();
  ASSERT_EQ(static_cast<int64_t>(extras.size()), rows.queries().size() - rows.centre_queries());
  ASSERT_GT(extras.size(), 10u);
  const float pixel = pathtrace::pixel_size(camera, 120);
  for (size_t k = 0; k < extras.size(); ++k) {
    const Vec3& p = rows.queries().position[static_cast<size_t>(rows.centre_queries()) + k];
    EXPECT_NEAR(extras[k].depth, -p.z, 1e-4f);
    const double x = 80 + p.x / -p.z / pixel, y = 60 - p.y / -p.z / pixel;  // where it is seen
    EXPECT_NEAR(x, extras[k].pixel % 160 + 0.5, 0.51);
    EXPECT_NEAR(y, 48 + extras[k].pixel / 160 + 0.5, 0.51);
  }
  const SparseLight light = light_sparsely(rows, {}, answer_smoothly);
  EXPECT_LT(light.answers, rows.queries().size());
  for (size_t i = 0; i < light.irradiance.size(); ++i) {
    const Rgb truth = smooth(rows.queries().position[i], rows.queries().normal[i]);
    // Four and a half pixels of 4 cm, over which `smooth` changes by 1.5 a metre at most.
    EXPECT_NEAR(light.irradiance[i].x, truth.x, 0.3f);
  }
}

TEST_F(SparseLightTest, WithoutTheQuadtreeEveryQueryIsAnswered) {
  const PictureBand rows = band(0, 120, 8);
  const SparseLight light = light_everywhere(rows, answer_smoothly);
  EXPECT_EQ(light.answers, rows.queries().size());
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    EXPECT_EQ(light.irradiance[i], smooth(rows.queries().position[i], rows.queries().normal[i]));
}

TEST_F(SparseLightTest, PicturesAskLessAndStayNear) {
  const test::TempDir folder;
  test::save_tiny_model(folder / "tiny.safetensors");
  renderer_.embed(runtime::Network(folder / "tiny.safetensors"), {});
  RenderSettings settings;
  settings.output = Output::Irradiance;
  settings.width = 160;
  settings.height = 120;
  const Frame every = renderer_.render(camera_, settings);
  EXPECT_EQ(every.decoded, every.queries);
  settings.sparse.emplace();
  const Frame few = renderer_.render(camera_, settings);
  EXPECT_EQ(few.queries, every.queries);
  EXPECT_LT(few.decoded, every.decoded / 2);
  double difference = 0, sum = 0;
  for (size_t i = 0; i < every.color.pixels.size(); ++i) {
    difference += std::abs(double{few.color.pixels[i]} - every.color.pixels[i]);
    sum += every.color.pixels[i];
  }
  EXPECT_LT(difference, 0.02 * sum);
  EXPECT_GT(difference, 0);
  // Another answerer stands in the network's place, for all and for few.
  settings.antialias = 0;
  settings.answerer = [](std::span<const gi::Query> queries) {
    return std::vector<Rgb>(queries.size(), Rgb{2, 3, 4});
  };
  for (const bool sparse : {true, false}) {
    if (!sparse) settings.sparse.reset();
    const Frame told = renderer_.render(camera_, settings);
    const int x = 80, y = 60;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(told.color.at(x, y)[c], 2.0f + c, 1e-5f);
    EXPECT_EQ(told.decoded == told.queries, !sparse);
  }
}

}  // namespace
}  // namespace lte::infer
