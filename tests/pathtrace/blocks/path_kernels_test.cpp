// What blocks compute on vectors, against the same written out for one lane.
#include "lte/pathtrace/blocks/path_kernels.h"

#include <memory>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/pathtrace/blocks/low_discrepancy.h"
#include "lte/pathtrace/lights/light_lanes.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

TEST(PathKernels, SobolPointsOfAnyIndex) {
  const std::vector<uint32_t> index{0, 1, 37, 255, 256, 70'001, 0x00fedcbau, 0xfedcba98u};
  const std::vector<int32_t> set{0, 1, 2, 0, 1, 2, 0, 1};
  const uint32_t seeds[] = {5, 0x9e3779b9u, 77};
  const auto count = static_cast<int>(index.size());
  for (int d = 0; d < kSobolDimensions; ++d) {
    std::vector<uint32_t> out(index.size());
    scrambled_sobol({index.data(), set.data(), count, 0xffffffffu}, d, seeds, out.data());
    for (size_t i = 0; i < index.size(); ++i) {
      uint32_t point = 0;
      for (size_t bit = 0; bit < 32; ++bit)
        if ((index[i] >> bit) & 1) point ^= reverse_bits(kSobolMatrix[bit][static_cast<size_t>(d)]);
      EXPECT_EQ(out[i], owen_scramble(point, seeds[set[i]])) << "index " << index[i];
    }
    std::vector<uint32_t> brief(4);  // a table of 256 is enough for these
    scrambled_sobol({index.data(), set.data(), 4, 255}, d, seeds, brief.data());
    EXPECT_EQ(brief, std::vector<uint32_t>(out.begin(), out.begin() + 4));
  }
}

TEST(PathKernels, RouletteKeepsTheMean) {
  constexpr int kCount = 200;
  const auto throughput = std::make_unique<Lanes3>();
  std::vector<uint32_t> u;
  std::vector<int32_t> survives(kCount);
  for (int i = 0; i < kCount; ++i) {
    throughput->put(i, i < 100 ? Vec3{0.2f, 0.5f, 0.4f} : Vec3{1.5f, 0.1f, 0});
    u.push_back(static_cast<uint32_t>((i % 100 + 0.5) / 100 * 0x1p32));
  }
  russian_roulette(u.data(), kCount, throughput.get(), survives.data());
  Vec3 sum;
  for (int i = 0; i < 100; ++i) sum += throughput->at(i) * static_cast<float>(survives[i]);
  EXPECT_NEAR(sum.x, 20, 1e-3);
  EXPECT_NEAR(sum.y, 50, 1e-3);
  EXPECT_NEAR(sum.z, 40, 1e-3);
  for (int i = 100; i < kCount; ++i) {
    EXPECT_EQ(survives[i], 1) << "more than 1 never ends";
    EXPECT_EQ(throughput->at(i), (Vec3{1.5f, 0.1f, 0}));
  }
}

scene::Scene with_point_light() {
  scene::Scene scene = test::furnished_room();
  test::add_point_light(&scene, {3, 1.5f, 0.5f}, {0.5f, 1, 2});
  return scene;
}

scene::Scene with_textured_light() {
  scene::Scene scene = test::furnished_room();
  scene.textures.push_back(
      std::make_shared<scene::Texture>(2, 1, std::vector<uint8_t>{255, 0, 0, 0, 255, 0}, true));
  for (scene::Material& material : scene.materials) {
    if (!material.emissive()) continue;
    material.emission_texture.texture = 0;
    material.double_sided = true;
    break;
  }
  return scene;
}

/// A block draws the lights that one point at a time would, whatever their kind.
TEST(LightLanes, AreTheSamplesOfSinglePoints) {
  for (const scene::Scene& scene :
       {test::furnished_room(), with_point_light(), with_textured_light(), test::hall_of_lamps()}) {
    const Lights lights(scene);
    const Bounds bounds = scene.bounds();
    const auto position = std::make_unique<Lanes3>(), normal = std::make_unique<Lanes3>();
    const auto numbers = std::make_unique<LightNumbers>();
    const auto block = std::make_unique<LightBlock>();
    Rng rng(3);
    for (int lane = 0; lane < kBlock; ++lane) {
      Vec3 p, n;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = bounds.low[axis] + rng.uniform() * bounds.extent()[axis];
        n[axis] = rng.uniform(-1, 1);
      }
      position->put(lane, p);
      normal->put(lane, normalize(n));
      numbers->choice[lane] = rng.next_u32();
      numbers->point_x[lane] = rng.next_u32();
      numbers->point_y[lane] = rng.next_u32();
    }
    sample_light_lanes(lights, *position, *normal, *numbers, kBlock, block.get());
    int arrived = 0;
    for (int lane = 0; lane < kBlock; ++lane) {
      const LightSample expected = lights.sample_in_frame(
          position->at(lane), normal->at(lane), numbers->choice[lane] * 0x1p-32,
          {to_unit(numbers->point_x[lane]), to_unit(numbers->point_y[lane])});
      const float pdf = expected.delta ? -expected.pdf : expected.pdf;
      EXPECT_NEAR(block->pdf[lane], pdf, 1e-4f * std::fabs(pdf)) << "lane " << lane;
      if (!(expected.pdf > 0)) continue;
      ++arrived;
      EXPECT_LT(length(block->direction.at(lane) - expected.direction), 1e-5f);
      EXPECT_NEAR(block->distance[lane], expected.distance, 1e-5f * expected.distance);
      EXPECT_EQ(block->light_group[lane], expected.light_group);
      EXPECT_LT(length(block->radiance.at(lane) - expected.radiance),
                1e-5f * length(expected.radiance));
    }
    EXPECT_GT(arrived, kBlock / 4);
  }
}

TEST(LightLanes, NothingArrivesWithoutLights) {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, test::add_material(&scene, {1, 1, 1}));
  const auto lanes = std::make_unique<Lanes3>();
  const auto numbers = std::make_unique<LightNumbers>();
  const auto block = std::make_unique<LightBlock>();
  std::fill_n(numbers->choice, 8, 1u), std::fill_n(numbers->point_x, 8, 1u);
  std::fill_n(numbers->point_y, 8, 1u);
  for (int lane = 0; lane < 8; ++lane) lanes->put(lane, {0, 1, 0});
  sample_light_lanes(Lights(scene), *lanes, *lanes, *numbers, 8, block.get());
  for (int lane = 0; lane < 8; ++lane) EXPECT_EQ(block->pdf[lane], 0);
}

/// An emissive triangle without area, a light at the point itself: weights stay finite.
TEST(PathKernels, DegenerateLightSamplesWeighNothing) {
  const TriangleLight light{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, 0.5f, 0, 1};
  const auto position = std::make_unique<Lanes3>(), normal = std::make_unique<Lanes3>();
  const auto block = std::make_unique<LightBlock>();
  const uint32_t entry[4] = {}, u[4] = {}, v[4] = {};
  const float probability[4] = {1, 1, 1, 0};
  float weight[4] = {-1, -1, -1, -1};
  position->put(0, {0, 0, 0});  // on the sampled corner
  position->put(1, {5, 0, 0});  // in its plane
  position->put(2, {0, 0, 2});
  position->put(3, {0, 0, 2});  // never chosen
  for (int lane = 0; lane < 4; ++lane) normal->put(lane, {0, 0, -1});
  sample_triangles(&light, entry, probability, u, v, 4, *position, block.get());
  weigh_diffuse(*normal, block->direction, block->pdf, 4, weight);
  EXPECT_EQ(weight[0], 0);
  EXPECT_EQ(weight[1], 0);
  EXPECT_NEAR(weight[2], (1 / kPi) / (4 / 0.5f + 1 / kPi), 1e-6);
  EXPECT_EQ(weight[3], 0);
}

}  // namespace
}  // namespace lte::pathtrace
