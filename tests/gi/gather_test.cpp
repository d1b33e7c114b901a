// Final gather against closed forms, and against the path tracer's whole paths.
#include "lte/gi/gather.h"

#include <algorithm>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/pathtrace/blocks/tile_sequence.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/sampler.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scenes.h"

namespace lte::gi {
namespace {

using test::add_instance;
using test::add_material;
using test::add_quad;

constexpr float kAlways = std::numeric_limits<float>::infinity();

/// In a closed box of radiance 1 and albedo ρ, light of depth 1 to d is π Σ_{k<d} ρ^k.
class Furnace : public testing::Test {
 protected:
  static constexpr float kAlbedo = 0.6f;
  Furnace() {
    const int wall = add_material(&scene_, {kAlbedo, kAlbedo, kAlbedo}, {1, 1, 1});
    add_instance(&scene_, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  }
  Gathered gather(int cache_depth, const GatherOptions& options) {
    const pathtrace::Bvh bvh(scene_);
    const pathtrace::Lights lights(scene_);
    const CacheRecords records = sample_records(bvh, 2000, 1);
    const auto light = [&](int depth) {
      const float e = kPi * static_cast<float>(test::geometric_sum(double{kAlbedo}, depth));
      return std::vector<Rgb>(static_cast<size_t>(records.size()), Rgb{e, e, e});
    };
    const IrradianceCache cache(bvh, records, light(cache_depth), {}, {}, light(cache_depth - 1));
    return gather_irradiance(bvh, lights, cache, positions_, normals_, options);
  }
  scene::Scene scene_;
  const std::vector<Vec3> positions_{{0, 0, -1}, {0.3f, 1, -0.2f}, {-1, 0.9f, 0.95f}};
  const std::vector<Vec3> normals_{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}};
};

TEST_F(Furnace, ReadsThePerfectTableWithoutNoise) {
  GatherOptions options;
  options.near = 0;
  const Gathered gathered = gather(4, options);
  const double expected = double{kPi} * (test::geometric_sum(double{kAlbedo}, 5) - 1);
  for (const Rgb& e : gathered.indirect) EXPECT_NEAR(double{e.x}, expected, 1e-4 * expected);
  EXPECT_EQ(gathered.lookups, 3 * 16);
  EXPECT_EQ(gathered.misses, 0);
  EXPECT_EQ(gathered.rays_traced, 3 * 16);
}

/// Rays that meet what shines, and as many light samples: together they are direct light.
TEST_F(Furnace, WhatItsRaysMeetCompletesLightSamples) {
  GatherOptions options;
  options.rays = 1024;
  const Gathered gathered = gather(3, options);
  const pathtrace::Bvh bvh(scene_);
  const pathtrace::Lights lights(scene_);
  pathtrace::DirectOptions direct;
  direct.hemisphere_share = 1;
  direct.hemisphere_elsewhere = true;
  const std::vector<uint64_t> streams{0, 1, 2};
  const pathtrace::DirectLight sampled = pathtrace::estimate_direct(
      bvh, lights, {positions_, normals_, streams}, std::vector<int32_t>(3, options.rays), direct);
  EXPECT_LE(sampled.rays_traced, 3 * options.rays) << "shadow rays alone";
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_GT(gathered.met[i].x, 0.2f);
    EXPECT_GT(sampled.irradiance[i].x, 0.2f);
    EXPECT_NEAR(gathered.met[i].x + sampled.irradiance[i].x, kPi, 0.02f * kPi) << i;
  }
}

TEST_F(Furnace, ASecondSegmentFindsLightOfAsManyBounces) {
  GatherOptions options;
  options.rays = 4096;
  options.near = kAlways;
  const Gathered gathered = gather(3, options);
  const double expected = double{kPi} * (test::geometric_sum(double{kAlbedo}, 4) - 1);
  for (const Rgb& e : gathered.indirect) EXPECT_NEAR(double{e.x}, expected, 0.01 * expected);
}

/// What paths find at their last depth is a part of all that they find.
TEST_F(Furnace, LightOfTheLastBounceIsKnownApart) {
  const pathtrace::Bvh bvh(scene_);
  const pathtrace::Lights lights(scene_);
  GatherOptions options;
  options.rays = 1024;
  options.max_depth = 4;
  options.last = true;
  const Gathered gathered =
      gather_irradiance(bvh, lights, IrradianceCache(bvh, {}, {}), positions_, normals_, options);
  pathtrace::IrradianceOptions paths;
  paths.max_depth = 4;
  paths.last_bounce = true;
  const pathtrace::Irradiance traced =
      pathtrace::estimate_irradiance(bvh, lights, positions_, normals_, paths);
  const double expected = double{kPi} * std::pow(double{kAlbedo}, 3);
  for (size_t i = 0; i < positions_.size(); ++i) {
    EXPECT_NEAR(gathered.last[i].x, expected, 0.03 * expected);
    EXPECT_NEAR(traced.last[i].x, expected, 0.03 * expected);
  }
}

/// Points of a room, with the reference and a cache that paths have filled.
struct Room {
  explicit Room(scene::Scene made)
      : scene(std::move(made)), bvh(scene), lights(scene), points(visible_points()) {}

  scene::SurfaceSamples visible_points() const {
    scene::SamplerOptions options;
    options.seed = 5;
    options.punctual_lights = false;
    scene::SurfaceSamples all = scene::sample_surface(scene, 150, options);
    return all;
  }
  std::vector<Rgb> reference(int max_depth) const {
    pathtrace::IrradianceOptions options;
    options.rays = 2048;
    options.max_depth = max_depth;
    const auto e =
        pathtrace::estimate_irradiance(bvh, lights, points.position, points.normal, options);
    std::vector<Rgb> out;
    for (int64_t i = 0; i < e.points; ++i) out.push_back(e.indirect_sum(i));
    return out;
  }
  IrradianceCache cache(int64_t count, int paths, int max_depth) const {
    const CacheRecords records = sample_records(bvh, count, 3);
    const RecordLight light = estimate_records(bvh, lights, records, paths, max_depth, 4);
    return IrradianceCache::of(std::make_shared<const CacheGeometry>(bvh, records), records, light);
  }

  scene::Scene scene;
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
  scene::SurfaceSamples points;
};

struct Errors {
  double bias, rms;  ///< relative to the mean reference
};

Errors errors(const std::vector<Rgb>& values, const std::vector<Rgb>& reference) {
  double sum = 0, difference = 0, squares = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double d = double{values[i][c]} - double{reference[i][c]};
      sum += double{reference[i][c]};
      difference += d;
      squares += d * d;
    }
  }
  const auto count = 3 * static_cast<double>(values.size());
  return {difference / sum, std::sqrt(squares / count) / (sum / count)};
}

TEST(Gather, MatchesPathsOfOneBounceMoreThanItsTable) {
  const Room room(test::furnished_room());
  const IrradianceCache cache = room.cache(3000, 128, 3);
  GatherOptions options;
  options.rays = 256;
  options.max_depth = 4;
  const Gathered gathered = gather_irradiance(room.bvh, room.lights, cache, room.points.position,
                                              room.points.normal, options);
  const Errors e = errors(gathered.indirect, room.reference(4));
  EXPECT_LT(std::fabs(e.bias), 0.02);
  EXPECT_LT(e.rms, 0.06);
  EXPECT_LT(gathered.misses, gathered.lookups / 10);
}

/// Where no first hit may read the table, second hits read light of one bounce less.
TEST(Gather, PathsThatReadLateFindNoLightOfMoreBounces) {
  const Room room(test::furnished_room());
  const IrradianceCache cache = room.cache(3000, 128, 2);
  GatherOptions options;
  options.rays = 256;
  options.near = kAlways;
  options.max_depth = 3;
  const Gathered gathered = gather_irradiance(room.bvh, room.lights, cache, room.points.position,
                                              room.points.normal, options);
  EXPECT_LT(std::fabs(errors(gathered.indirect, room.reference(3)).bias), 0.02);
}

TEST(Gather, WithoutATableItIsPathTracing) {
  const Room room(test::furnished_room());
  GatherOptions options;
  options.rays = 1024;
  options.max_depth = 4;
  const Gathered gathered =
      gather_irradiance(room.bvh, room.lights, IrradianceCache(room.bvh, {}, {}),
                        room.points.position, room.points.normal, options);
  const Errors e = errors(gathered.indirect, room.reference(4));
  EXPECT_LT(std::fabs(e.bias), 0.01);
  EXPECT_LT(e.rms, 0.06);
}

TEST(Gather, FollowsMetalToTheSurfaceThatItMirrors) {
  scene::Scene scene = test::furnished_room();
  add_quad(&scene, {3.9f, 0.2f, 0.2f}, {0, 0, 2.5f}, {0, 2, 0},
           test::add_metal(&scene, {0.9f, 0.8f, 0.7f}, 0.2f));
  const Room room(std::move(scene));
  const IrradianceCache cache = room.cache(3000, 128, 5);
  GatherOptions options;
  options.rays = 256;
  options.max_depth = 6;
  const Gathered gathered = gather_irradiance(room.bvh, room.lights, cache, room.points.position,
                                              room.points.normal, options);
  const Errors e = errors(gathered.indirect, room.reference(6));
  EXPECT_LT(std::fabs(e.bias), 0.02);
  EXPECT_LT(e.rms, 0.1);
}

TEST(Gather, LightThatArrivesAtOnceIsNotIndirect) {
  scene::Scene scene;
  const int white = add_material(&scene, {0.8f, 0.8f, 0.8f});
  const int lamp = add_material(&scene, {0, 0, 0}, {10, 10, 10});
  add_quad(&scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, white);
  add_quad(&scene, {-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, lamp);  // looks down
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const std::vector<Vec3> positions{{0, 0, 0}}, normals{{0, 0, 1}};
  const Gathered gathered =
      gather_irradiance(bvh, lights, IrradianceCache(bvh, {}, {}), positions, normals, {});
  EXPECT_EQ(gathered.indirect[0], Rgb{});
}

TEST(Gather, DoesNotDependOnHowQueriesAreCutIntoCalls) {
  const Room room(test::furnished_room());
  const IrradianceCache cache = room.cache(500, 16, 3);
  const auto& p = room.points.position;
  const auto& n = room.points.normal;
  GatherOptions options;
  options.rays = 24;
  const std::vector<Rgb> whole =
      gather_irradiance(room.bvh, room.lights, cache, p, n, options).indirect;
  const auto part = [&](size_t first, size_t count) {
    return gather_irradiance(room.bvh, room.lights, cache, std::span(p).subspan(first, count),
                             std::span(n).subspan(first, count), options,
                             static_cast<int64_t>(first))
        .indirect;
  };
  std::vector<Rgb> parts = part(0, 37);
  const std::vector<Rgb> rest = part(37, p.size() - 37);
  parts.insert(parts.end(), rest.begin(), rest.end());
  EXPECT_EQ(parts, whole);
}

/// Means over neighbors that see the same have less noise than as many points by themselves.
TEST(Gather, NeighborsFillEachOthersGaps) {
  const Room room(test::furnished_room());
  const IrradianceCache cache = room.cache(1000, 16, 3);
  constexpr int kPoints = 64, kSeeds = 48;
  const std::vector<Vec3> position(kPoints, {2, 0, 1}), normal(kPoints, {0, 1, 0});
  double within = 0, sum = 0, squares = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    GatherOptions options;
    options.rays = 4;
    options.seed = static_cast<uint64_t>(seed);
    const Gathered gathered =
        gather_irradiance(room.bvh, room.lights, cache, position, normal, options);
    double of_seed = 0, of_squares = 0;
    for (const Rgb& e : gathered.indirect) {
      of_seed += double{e.x} / kPoints;
      of_squares += double{e.x} * double{e.x} / kPoints;
    }
    within += (of_squares - of_seed * of_seed) / kSeeds;
    sum += of_seed / kSeeds;
    squares += of_seed * of_seed / kSeeds;
  }
  EXPECT_LT(squares - sum * sum, 0.25 * within / kPoints);
}

/// Calls that share the point set of a tile: points in any order, cut anyhow, find the same, and
/// the mean of all calls has less noise than that of as many calls by themselves.
TEST(Gather, CallsGoOnInOnePointSet) {
  const Room room(test::furnished_room());
  const IrradianceCache cache = room.cache(1000, 16, 3);
  constexpr uint32_t kCalls = 8;
  constexpr int kSeeds = 96;
  const std::vector<Vec3> position(pathtrace::kTilePlaces, {2, 0, 1});
  const std::vector<Vec3> normal(pathtrace::kTilePlaces, {0, 1, 0});
  const auto call = [&](uint64_t set, uint32_t number) {
    std::vector<pathtrace::SampleNumber> numbers;
    for (uint32_t place = 0; place < pathtrace::kTilePlaces; ++place)
      numbers.push_back({set, place, number});
    GatherOptions options;
    options.rays = 1;
    options.numbers = numbers;
    const std::vector<Rgb> all =
        gather_irradiance(room.bvh, room.lights, cache, position, normal, options).indirect;
    constexpr size_t kFirst = 23;
    std::reverse(numbers.begin(), numbers.begin() + kFirst);
    options.numbers = std::span(numbers).first(kFirst);
    std::vector<Rgb> some =
        gather_irradiance(room.bvh, room.lights, cache, std::span(position).first(kFirst),
                          std::span(normal).first(kFirst), options)
            .indirect;
    std::reverse(some.begin(), some.end());
    EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
    double mean = 0;
    for (const Rgb& e : all) mean += double{e.x} / pathtrace::kTilePlaces;
    return mean;
  };
  const auto variance = [&](bool one_set) {
    double sum = 0, squares = 0;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      double mean = 0;
      for (uint32_t k = 0; k < kCalls; ++k)
        mean += (one_set ? call(seed, k) : call(1000 + seed * kCalls + k, 0)) / kCalls;
      sum += mean / kSeeds;
      squares += mean * mean / kSeeds;
    }
    return squares - sum * sum;
  };
  EXPECT_LT(variance(true), 0.75 * variance(false));
}

TEST(Gather, RefusesOptionsOutOfRange) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const IrradianceCache cache(bvh, {}, {});
  const auto gather = [&](const GatherOptions& options) {
    gather_irradiance(bvh, lights, cache, {}, {}, options);
  };
  GatherOptions options;
  gather(options);
  options.rays = 0;
  EXPECT_THROW(gather(options), Error);
  options = {};
  options.near = -1;
  EXPECT_THROW(gather(options), Error);
  options = {};
  options.max_depth = 1;
  EXPECT_THROW(gather(options), Error);
  options = {};
  const std::vector<pathtrace::SampleNumber> numbers(1);
  options.numbers = numbers;
  EXPECT_THROW(gather(options), Error) << "of no point";
}

}  // namespace
}  // namespace lte::gi
