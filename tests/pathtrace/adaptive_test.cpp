// Paths by error: no bias, honest variance, the target met, the bounds kept.
#include "lte/pathtrace/adaptive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/scene/sampler.h"
#include "tests/support/mean.h"
#include "tests/support/room.h"

namespace lte::pathtrace {
namespace {

using test::Mean;

using test::Room;
using testing::HasSubstr;
using testing::ThrowsMessage;

double channel_mean(const Rgb& value) { return (value.x + value.y + value.z) / 3; }

/// A lamp that shines onto a small patch of the ceiling: most paths bring little, a few much. The
/// skew is what stopping early feeds on.
Room uplit_room() {
  scene::Scene scene;
  const int white = test::add_material(&scene, {0.6f, 0.6f, 0.6f});
  const int lamp = test::add_material(&scene, {0.1f, 0.1f, 0.1f}, {40, 40, 40});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2.5f, 3}, white, true));
  test::add_quad(&scene, {1.5f, 1.9f, 1}, {0, 0, 1}, {1, 0, 0}, lamp);  // z × x = y: up
  return Room(std::move(scene));
}

constexpr int kDepth = 3;

/// Indirect irradiance of the room's points by a long run, with its standard error.
struct Reference {
  explicit Reference(const Room& room) {
    IrradianceOptions options;
    options.rays = 1 << 16;
    options.max_depth = kDepth;
    options.seed = 1234;
    const Irradiance e = room.estimate(options);
    for (int64_t i = 0; i < e.points; ++i) {
      mean.push_back(channel_mean(e.indirect_sum(i)));
      total.push_back(channel_mean(e.total(i)));
      error.push_back(std::sqrt(e.variance[static_cast<size_t>(i)]));
      scene += mean.back() / static_cast<double>(e.points);
    }
  }
  std::vector<double> mean, total, error;
  double scene = 0;
};

AdaptiveIrradiance adaptive(const Room& room, const AdaptiveOptions& options) {
  return estimate_adaptive(room.bvh, room.lights, room.positions, room.normals, options);
}

/// Takes 16 paths more until the spread over all such batches says that the error is small.
double stop_when_small(const Room& room, size_t point, double wanted_error, uint64_t seed) {
  Mean batches;
  IrradianceOptions options;
  options.rays = 16;
  options.max_depth = kDepth;
  do {
    options.seed = hash_combine(seed, static_cast<uint64_t>(batches.count));
    const Irradiance e =
        estimate_irradiance(room.bvh, room.lights, std::span(room.positions).subspan(point, 1),
                            std::span(room.normals).subspan(point, 1), options);
    batches.add(channel_mean(e.indirect_sum(0)));
  } while (batches.count < 2 || (batches.count < 32 && batches.error() > wanted_error));
  return batches.value();
}

/// With 3,000 runs and a reference of 2^19 paths the five means were within 0.5 % of the truth (|z|
/// at most 1.75), and those of stopping on its own samples 7 to 11 % below it (z from -14 to
/// -17).
TEST(Adaptive, IsUnbiasedWhereStoppingOnItsOwnSamplesIsNot) {
  const Room room = uplit_room();
  const Reference reference(room);
  constexpr int kRuns = 300;
  for (const ErrorScale scale : {ErrorScale::MeanIndirect, ErrorScale::OwnTotal}) {
    AdaptiveOptions options;
    options.scale = scale;
    options.max_depth = kDepth;
    options.min_rays = 32;
    options.max_rays = 512;
    options.target_error = scale == ErrorScale::MeanIndirect ? 0.2 : 0.15;
    std::vector<Mean> means(room.positions.size());
    Mean rays;
    for (int run = 0; run < kRuns; ++run) {
      options.seed = static_cast<uint64_t>(run);
      const AdaptiveIrradiance e = adaptive(room, options);
      for (size_t i = 0; i < means.size(); ++i) {
        means[i].add(channel_mean(e.irradiance.indirect_sum(static_cast<int64_t>(i))));
        rays.add(e.rays[i]);
      }
    }
    EXPECT_GT(rays.variance(), 40 * 40) << "the rule must have had something to decide";
    for (size_t i = 0; i < means.size(); ++i) {
      const double error = std::hypot(means[i].error(), reference.error[i]);
      EXPECT_NEAR(means[i].value(), reference.mean[i], 3 * error) << "point " << i;
    }
  }
  Mean naive;
  for (uint64_t run = 0; run < kRuns; ++run)
    naive.add(stop_when_small(room, 0, 0.2 * reference.scene, run));
  EXPECT_LT(naive.value(), reference.mean[0] - 4 * std::hypot(naive.error(), reference.error[0]));
}

TEST(Adaptive, StatedVarianceIsThatOfRunsWithOtherSeeds) {
  const Room room;
  AdaptiveOptions options;
  options.max_depth = 2;
  options.target_error = 0.08;
  constexpr int kRuns = 300;
  std::vector<Mean> red(room.positions.size());
  double stated = 0, true_variance = 0;
  for (int run = 0; run < kRuns; ++run) {
    options.seed = static_cast<uint64_t>(run);
    const AdaptiveIrradiance e = adaptive(room, options);
    for (size_t i = 0; i < red.size(); ++i) {
      red[i].add(e.irradiance.total(static_cast<int64_t>(i)).x);
      stated += e.irradiance.variance_total[i].x / kRuns;
    }
  }
  for (const Mean& point : red) true_variance += point.variance();
  EXPECT_NEAR(stated / true_variance, 1, 0.12);
}

/// Points over the room's surfaces.
scene::SurfaceSamples points_of(const Room& room, int64_t count) {
  return scene::sample_surface(room.scene, count, {.seed = 2, .punctual_lights = false});
}

TEST(Adaptive, MeetsTheTargetWithFewerPathsWhereLessIsNeeded) {
  const Room room;
  const scene::SurfaceSamples points = points_of(room, 150);
  AdaptiveOptions options;
  options.max_depth = 3;
  options.target_error = 0.05;
  const AdaptiveIrradiance e =
      estimate_adaptive(room.bvh, room.lights, points.position, points.normal, options);
  double mean = 0, variance = 0;
  int32_t fewest = 1 << 30, most = 0;
  int64_t paths = 0;
  for (size_t i = 0; i < points.position.size(); ++i) {
    mean += channel_mean(e.irradiance.indirect_sum(static_cast<int64_t>(i))) / 150;
    variance += e.irradiance.variance[i] / 150;
    fewest = std::min(fewest, e.rays[i]);
    most = std::max(most, e.rays[i]);
    paths += e.rays[i];
  }
  EXPECT_LT(std::sqrt(variance), 0.05 * mean);
  EXPECT_GT(std::sqrt(variance), 0.02 * mean) << "far more paths than were asked for";
  EXPECT_GE(fewest, 64);
  EXPECT_LT(fewest, most);
  EXPECT_LE(most, 4096);
  EXPECT_EQ(e.paths, paths) << "the pilot is part of the estimate";
  EXPECT_EQ(e.irradiance.rays, std::llround(static_cast<double>(paths) / 150));
}

TEST(Adaptive, KeepsItsBounds) {
  const Room room;
  AdaptiveOptions options;
  options.max_depth = 2;
  options.target_error = 1e3;
  for (const int32_t rays : adaptive(room, options).rays) EXPECT_EQ(rays, 64);
  options.target_error = 1e-6;
  options.max_rays = 512;
  const AdaptiveIrradiance capped = adaptive(room, options);
  for (const int32_t rays : capped.rays) EXPECT_EQ(rays, 512);
  EXPECT_EQ(capped.missed, 5);
  options.target_error = 0.02;
  const AdaptiveIrradiance alone =
      estimate_adaptive(room.bvh, room.lights, std::span(room.positions).first(1),
                        std::span(room.normals).first(1), options);
  EXPECT_EQ(alone.rays[0], 512) << "a single point has no neighbour to ask";
  EXPECT_EQ(estimate_adaptive(room.bvh, room.lights, {}, {}, options).rays.size(), 0u);
}

TEST(Adaptive, BlackScenesTakeThePilotOnly) {
  scene::Scene scene = test::furnished_room();
  for (scene::Material& material : scene.materials) material.emission = {};
  const AdaptiveIrradiance e = adaptive(Room(std::move(scene)), {});
  EXPECT_EQ(e.irradiance.rays_traced, 0);
  EXPECT_EQ(e.missed, 0);
  for (const int32_t rays : e.rays) EXPECT_EQ(rays, 64);
}

TEST(Adaptive, DoesNotDependOnThreads) {
  const Room room;
  const scene::SurfaceSamples points = points_of(room, 60);
  AdaptiveOptions options;
  options.target_error = 0.1;
  set_num_threads(1);
  const auto run = [&] {
    return estimate_adaptive(room.bvh, room.lights, points.position, points.normal, options);
  };
  const AdaptiveIrradiance one = run();
  set_num_threads(3);
  const AdaptiveIrradiance three = run();
  set_num_threads(0);
  EXPECT_EQ(one.rays, three.rays);
  EXPECT_EQ(one.irradiance.indirect, three.irradiance.indirect);
  EXPECT_EQ(one.irradiance.variance, three.irradiance.variance);
}

TEST(Adaptive, NamesWhatItRefuses) {
  const Room room;
  const auto error = [&room](auto change, const char* text) {
    AdaptiveOptions options;
    change(&options);
    EXPECT_THAT([&] { adaptive(room, options); }, ThrowsMessage<Error>(HasSubstr(text)));
  };
  error([](AdaptiveOptions* o) { o->target_error = 0; }, "target_error");
  error([](AdaptiveOptions* o) { o->target_error = NAN; }, "target_error");
  error([](AdaptiveOptions* o) { o->min_rays = 1; }, "min_rays");
  error([](AdaptiveOptions* o) { o->max_rays = 32; }, "max_rays");
  error([](AdaptiveOptions* o) { o->max_depth = 0; }, "max_depth");
}

}  // namespace
}  // namespace lte::pathtrace
