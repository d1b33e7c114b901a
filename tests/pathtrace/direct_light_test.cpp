// Direct light of many points: closed forms, agreement with whole paths, honest variance, and what
// the result must not depend on.
#include "lte/pathtrace/direct_light.h"

#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/tile_sequence.h"
#include "tests/support/closed_forms.h"
#include "tests/support/every_light.h"
#include "tests/support/mean.h"
#include "tests/support/room.h"

namespace lte::pathtrace {
namespace {

using test::Mean;

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Points of test::dark_room() on floor, walls and the outer box, in sun, shadow and penumbra.
struct Points {
  std::vector<Vec3> positions{{3.6f, 0, 1.5f}, {0, 2, 1.5f}, {0.4f, 0, 0.3f},
                              {2, 2.1f, 1.5f}, {2, 0, 0.2f}, {0, 0.5f, 0.1f}};
  std::vector<Vec3> normals{{0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}};
  std::vector<uint64_t> streams{0, 1, 2, 3, 4, 5};

  DirectPoints all() const { return {positions, normals, streams}; }
};

TEST(DirectLight, OfARectangleIsItsClosedForm) {
  scene::Scene scene;
  const int black = test::add_material(&scene, {0, 0, 0}, {5, 4, 3});
  test::add_quad(&scene, {-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, black);  // looks down
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> polygon{
      {-0.5f, 2, -0.5f}, {0.5f, 2, -0.5f}, {0.5f, 2, 0.5f}, {-0.5f, 2, 0.5f}};
  // The last point nearly touches the light, where light samples alone are all noise.
  const std::vector<Vec3> positions{{0, 0, 0}, {1.5f, 0.5f, 0.2f}, {0.1f, 1.98f, 0.2f}};
  const std::vector<Vec3> normals(3, Vec3{0, 1, 0});
  const std::vector<uint64_t> streams{0, 1, 2};
  for (const float share : {0.25f, 1.0f}) {
    DirectOptions options;
    options.hemisphere_share = share;
    const DirectLight light = estimate_direct(bvh, lights, {positions, normals, streams},
                                              std::vector<int32_t>(3, 1 << 14), options);
    for (size_t i = 0; i < positions.size(); ++i) {
      const double expected = 5 * test::polygon_irradiance(polygon, positions[i], normals[i]);
      EXPECT_NEAR(light.irradiance[i].x, expected, 0.01 * expected) << "point " << i;
      EXPECT_NEAR(light.irradiance[i].z, 0.6f * light.irradiance[i].x, 1e-4 * expected);
    }
  }
}

TEST(DirectLight, AgreesWithWholePathsUnderEveryLight) {
  for (const test::LitScene& lit : test::scenes_of_every_light()) {
    const Bvh bvh(lit.scene);
    const Points points;
    for (const LightChoice choice : {LightChoice::Power, LightChoice::Tree}) {
      const Lights lights(lit.scene, choice);
      IrradianceOptions paths;
      paths.rays = 1 << 14;
      paths.direct_only = true;
      const Irradiance expected =
          estimate_irradiance(bvh, lights, points.positions, points.normals, paths);
      DirectOptions options;
      options.seed = 9;
      options.variance = true;
      const DirectLight light =
          estimate_direct(bvh, lights, points.all(), std::vector<int32_t>(6, 1 << 13), options);
      for (size_t i = 0; i < 6; ++i) {
        const Rgb wanted = expected.direct_sum(static_cast<int64_t>(i));
        const double error = std::sqrt(2.0f * expected.variance_total[i].x);
        EXPECT_NEAR(light.irradiance[i].x, wanted.x, 5 * error + 0.01 * wanted.x)
            << lit.light << ", point " << i;
      }
    }
  }
}

/// Whatever the number of samples and the share of rays over the hemisphere, down to one sample
/// with a ray now and then.
TEST(DirectLight, OfFewSamplesIsUnbiasedAndItsVarianceHonest) {
  const test::Room room;
  const std::vector<uint64_t> streams{0, 1, 2, 3, 4};
  IrradianceOptions paths;
  paths.rays = 1 << 16;
  paths.direct_only = true;
  const Irradiance expected = room.estimate(paths);
  constexpr int kSeeds = 3000;
  for (const int samples : {1, 3, 8}) {
    for (const float share : {0.0f, 0.25f, 1.0f}) {
      std::vector<Mean> means(streams.size()), luminances(streams.size());
      std::vector<double> claimed(streams.size());
      for (int seed = 0; seed < kSeeds; ++seed) {
        DirectOptions options;
        options.seed = static_cast<uint64_t>(seed);
        options.hemisphere_share = share;
        options.variance = true;
        const DirectLight light =
            estimate_direct(room.bvh, room.lights, {room.positions, room.normals, streams},
                            std::vector<int32_t>(streams.size(), samples), options);
        for (size_t i = 0; i < means.size(); ++i) {
          means[i].add(light.irradiance[i].x);
          luminances[i].add(luminance(light.irradiance[i]));
          claimed[i] += light.variance[i] / kSeeds;
        }
      }
      for (size_t i = 0; i < means.size(); ++i) {
        const Rgb wanted = expected.direct_sum(static_cast<int64_t>(i));
        const double error = std::hypot(means[i].error(), std::sqrt(expected.variance_total[i].x));
        EXPECT_NEAR(means[i].value(), wanted.x, 4.5 * error + 1e-4 * wanted.x)
            << samples << " samples, share " << share << ", point " << i;
        if (samples == 1) {
          EXPECT_EQ(claimed[i], std::numeric_limits<double>::infinity());
        } else if (samples == 8) {
          EXPECT_NEAR(claimed[i], luminances[i].variance(), 0.25 * claimed[i]) << "point " << i;
        }
      }
    }
  }
}

TEST(DirectLight, DependsNeitherOnThreadsNorOnThePointsBesideIt) {
  const test::Room room;
  std::vector<Vec3> positions, normals;
  std::vector<uint64_t> streams;
  std::vector<int32_t> samples;
  for (uint64_t i = 0; i < 700; ++i) {
    positions.push_back(room.positions[i % 5]);
    normals.push_back(room.normals[i % 5]);
    streams.push_back(i);
    samples.push_back(static_cast<int32_t>(i % 7 == 6 ? 300 : i % 7));
  }
  DirectOptions options;
  options.variance = true;
  const DirectLight all =
      estimate_direct(room.bvh, room.lights, {positions, normals, streams}, samples, options);
  const int threads = num_threads();
  set_num_threads(1);
  const DirectLight one =
      estimate_direct(room.bvh, room.lights, {positions, normals, streams}, samples, options);
  set_num_threads(threads);
  EXPECT_EQ(all.irradiance, one.irradiance);
  EXPECT_EQ(all.variance, one.variance);
  EXPECT_EQ(all.rays_traced, one.rays_traced);
  for (const size_t i : {size_t{0}, size_t{3}, size_t{6}, size_t{699}}) {
    const DirectLight alone =
        estimate_direct(room.bvh, room.lights,
                        {std::span(positions).subspan(i, 1), std::span(normals).subspan(i, 1),
                         std::span(streams).subspan(i, 1)},
                        std::span(samples).subspan(i, 1), options);
    EXPECT_EQ(alone.irradiance[0], all.irradiance[i]) << "point " << i;
  }
  EXPECT_EQ(all.irradiance[0], Rgb{}) << "no samples, no light";
}

/// As right as any, and the mean of all calls has less noise than that of as many sets by
/// themselves.
TEST(DirectLight, SamplesThatGoOnAreSpreadOverCalls) {
  const test::Room room;
  IrradianceOptions paths;
  paths.rays = 1 << 16;
  paths.direct_only = true;
  const Irradiance expected = room.estimate(paths);
  constexpr uint32_t kCalls = 8, kSamples = 2;
  constexpr int kSeeds = 100;
  const std::vector<int32_t> samples(kTilePlaces, kSamples);
  for (size_t i = 0; i < room.positions.size(); ++i) {
    const std::vector<Vec3> position(kTilePlaces, room.positions[i]),
        normal(kTilePlaces, room.normals[i]);
    const auto call = [&](uint64_t set, uint32_t number) {
      std::vector<SampleNumber> numbers;
      for (uint32_t place = 0; place < kTilePlaces; ++place)
        numbers.push_back({set, place, number});
      return estimate_direct(room.bvh, room.lights, {position, normal, {}, {}, numbers}, samples,
                             {})
          .irradiance;
    };
    std::array<Mean, 2> found;  // in sets by themselves, in one
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      for (const bool one : {false, true}) {
        std::vector<double> sums(kTilePlaces);
        for (uint32_t k = 0; k < kCalls; ++k) {
          const std::vector<Rgb> light =
              one ? call(seed, k * kSamples) : call(1000 + seed * kCalls + k, 0);
          for (size_t p = 0; p < sums.size(); ++p) sums[p] += double{light[p].x} / kCalls;
        }
        for (const double sum : sums) found[one].add(sum);
      }
    }
    const Rgb wanted = expected.direct_sum(static_cast<int64_t>(i));
    const double error = std::hypot(found[1].error(), std::sqrt(expected.variance_total[i].x));
    EXPECT_NEAR(found[1].value(), wanted.x, 4.5 * error + 1e-4 * wanted.x) << "point " << i;
    EXPECT_LT(found[1].variance(), 0.35 * found[0].variance()) << "point " << i;
  }
}

TEST(DirectLight, NeedsNoRaysWithoutLight) {
  scene::Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, test::add_material(&scene, {1, 1, 1}));
  const Bvh bvh(scene);
  const Lights lights(scene);
  const Points points;
  const DirectLight light =
      estimate_direct(bvh, lights, points.all(), std::vector<int32_t>(6, 4), {});
  EXPECT_EQ(light.rays_traced, 0);
  EXPECT_THAT(light.irradiance, testing::Each(Rgb{}));
}

TEST(DirectLight, NamesWhatIsWrong) {
  const test::Room room;
  const Points points;
  const auto ask = [&](std::vector<int32_t> samples, const DirectOptions& options = {}) {
    return [&points, &room, samples = std::move(samples), options] {
      estimate_direct(room.bvh, room.lights, points.all(), samples, options);
    };
  };
  EXPECT_THAT(ask({1, 2}), ThrowsMessage<Error>(HasSubstr("6 streams, 0 numbers and 2 counts")));
  EXPECT_THAT(ask({1, 1, 1, -1, 1, 1}), ThrowsMessage<Error>(HasSubstr("samples of point 3")));
  DirectOptions wrong;
  wrong.hemisphere_share = 2;
  EXPECT_THAT(ask({1, 1, 1, 1, 1, 1}, wrong), ThrowsMessage<Error>(HasSubstr("hemisphere_share")));
  const std::vector<SampleNumber> numbers(6);
  const std::vector<int32_t> samples(6, 2);
  DirectPoints going_on{points.positions, points.normals, {}, {}, numbers};
  wrong = {};
  wrong.variance = true;
  EXPECT_THROW(estimate_direct(room.bvh, room.lights, going_on, samples, wrong), Error);
  going_on.streams = points.streams;
  EXPECT_THROW(estimate_direct(room.bvh, room.lights, going_on, samples, {}), Error) << "both";
}

}  // namespace
}  // namespace lte::pathtrace
