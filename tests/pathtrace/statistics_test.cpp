// What the estimator promises beyond its mean: honest variance, unbiased roulette, determinism,
// linearity, errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/room.h"

namespace lte::pathtrace {
namespace {

using test::Room;
using testing::HasSubstr;
using testing::ThrowsMessage;

void expect_equal(const Irradiance& a, const Irradiance& b) {
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.variance_total, b.variance_total);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.rays_traced, b.rays_traced);
}

/// Variance of a color over runs, by channel.
class Moments {
 public:
  void add(const Rgb& value) {
    ++count_;
    for (int c = 0; c < 3; ++c) sum_[c] += value[c], squares_[c] += double{value[c]} * value[c];
  }
  double variance(int c) const { return (squares_[c] - sum_[c] * sum_[c] / count_) / (count_ - 1); }
  double mean_variance() const { return (variance(0) + variance(1) + variance(2)) / 3; }

 private:
  int count_ = 0;
  double sum_[3] = {}, squares_[3] = {};
};

TEST(Variance, IsThatOfRunsWithOtherSeeds) {
  const Room room;
  constexpr int kSeeds = 400;
  for (const int rays : {6, 40, 64, 320}) {
    const size_t count = room.positions.size();
    std::vector<Moments> total(count), indirect(count);
    std::vector<double> claimed_total(count), claimed_indirect(count);
    for (int seed = 0; seed < kSeeds; ++seed) {
      IrradianceOptions options;
      options.rays = rays;
      options.seed = static_cast<uint64_t>(seed);
      const Irradiance e = room.estimate(options);
      for (size_t i = 0; i < count; ++i) {
        total[i].add(e.total(static_cast<int64_t>(i)));
        indirect[i].add(e.indirect_sum(static_cast<int64_t>(i)));
        claimed_total[i] += e.variance_total[i].y / kSeeds;
        claimed_indirect[i] += e.variance[i] / kSeeds;
      }
    }
    double total_ratio = 0, indirect_ratio = 0;
    for (size_t i = 0; i < count; ++i) {
      total_ratio += claimed_total[i] / total[i].variance(1) / static_cast<double>(count);
      indirect_ratio +=
          claimed_indirect[i] / indirect[i].mean_variance() / static_cast<double>(count);
    }
    // 400 runs know a variance to 7 %, so five points know the ratio to 3 %, or less well where
    // tails are heavy.
    EXPECT_NEAR(total_ratio, 1, 0.12) << rays << " rays";
    EXPECT_NEAR(indirect_ratio, 1, 0.12) << rays << " rays";
  }
}

TEST(Variance, OfFewIndependentPathsFallsAsOneOverTheirNumber) {
  const Room room;
  constexpr int kSeeds = 1500;
  const size_t count = room.positions.size();
  const auto mean_variance = [&](int rays, double* mean) {
    std::vector<Moments> moments(count);
    *mean = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      IrradianceOptions options;
      options.rays = rays;
      options.variance = false;
      options.seed = hash_combine(static_cast<uint64_t>(rays), static_cast<uint64_t>(seed));
      const Irradiance e = room.estimate(options);
      EXPECT_EQ(e.rays, rays);
      EXPECT_TRUE(e.variance.empty() && e.variance_total.empty());
      for (size_t i = 0; i < count; ++i) {
        const Rgb value = e.indirect_sum(static_cast<int64_t>(i));
        moments[i].add(value);
        *mean += (value.x + value.y + value.z) / (3.0 * kSeeds * static_cast<double>(count));
      }
    }
    double sum = 0;
    for (const Moments& point : moments) sum += point.mean_variance();
    return sum / static_cast<double>(count);
  };
  double mean_1 = 0, mean_4 = 0, mean_16 = 0;
  const double of_1 = mean_variance(1, &mean_1), of_4 = mean_variance(4, &mean_4),
               of_16 = mean_variance(16, &mean_16);
  const double error_1 = std::sqrt(of_1 / (kSeeds * static_cast<double>(count)));
  EXPECT_NEAR(mean_1, mean_16, 4.5 * error_1);
  EXPECT_NEAR(mean_4, mean_16, 4.5 * error_1 / 2);
  // Both variances are known to some percent.
  EXPECT_NEAR(of_1 / of_4, 4, 0.8);
  EXPECT_GT(of_4 / of_16, 3.2) << "pairs of the 16 are stratified: not less than 4 but for noise";
  EXPECT_LT(of_4 / of_16, 8);
}

TEST(Variance, IsLeftOutWithoutAChangeOfValues) {
  const Room room;
  for (const int rays : {2, 16, 64}) {
    IrradianceOptions options;
    options.rays = rays;
    const Irradiance with = room.estimate(options);
    options.variance = false;
    const Irradiance without = room.estimate(options);
    EXPECT_EQ(with.indirect, without.indirect);
    EXPECT_EQ(with.direct, without.direct);
    EXPECT_EQ(with.rays, without.rays);
  }
}

TEST(Variance, FallsAtLeastAsOneOverRays) {
  const Room room;
  IrradianceOptions few, many;
  few.rays = 64;
  many.rays = 4096;
  double ratio = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    few.seed = many.seed = seed;
    const Irradiance a = room.estimate(few), b = room.estimate(many);
    for (int64_t i = 0; i < a.points; ++i) ratio += b.variance[i] / a.variance[i] / 100;
  }
  EXPECT_LT(ratio, 1.5 / 64);
}

TEST(Roulette, DoesNotShiftTheMean) {
  const Room room;
  IrradianceOptions options;
  options.rays = 1 << 14;
  options.max_depth = 8;
  options.roulette_depth = 1000;
  const Irradiance without = room.estimate(options);
  for (const int depth : {1, 3}) {
    options.roulette_depth = depth;
    options.seed = 9;
    const Irradiance with = room.estimate(options);
    EXPECT_LT(with.rays_traced, without.rays_traced) << "it must end some paths";
    for (int64_t i = 0; i < with.points; ++i) {
      for (int c = 0; c < 3; ++c) {
        const double error = std::sqrt(with.variance_total[i][c] + without.variance_total[i][c]);
        EXPECT_NEAR(with.total(i)[c], without.total(i)[c], 4 * error) << i << ' ' << c;
      }
    }
  }
}

TEST(Estimate, DependsNeitherOnThreadsNorOnCuts) {
  const Room room;
  IrradianceOptions options;
  options.rays = 128;
  options.seed = 5;
  set_num_threads(1);
  const Irradiance one = room.estimate(options, 7);
  set_num_threads(3);
  expect_equal(one, room.estimate(options, 7));
  expect_equal(one, Room().estimate(options, 7));  // a BVH built by other threads
  set_num_threads(0);
  for (int64_t i = 0; i < one.points; ++i) {
    const auto point = static_cast<size_t>(i);
    const Irradiance alone =
        estimate_irradiance(room.bvh, room.lights, std::span(room.positions).subspan(point, 1),
                            std::span(room.normals).subspan(point, 1), options, 7 + i);
    EXPECT_EQ(alone.total(0), one.total(i));
    EXPECT_EQ(alone.variance[0], one.variance[point]);
  }
  options.seed = 6;
  EXPECT_NE(room.estimate(options, 7).direct, one.direct);
}

TEST(Estimate, DirectLightIsTheSameAtAnyDepth) {
  const Room room;
  IrradianceOptions options;
  options.rays = 64;
  const Irradiance deep = room.estimate(options);
  options.direct_only = true;
  const Irradiance direct = room.estimate(options);
  EXPECT_EQ(deep.direct, direct.direct);
  EXPECT_LT(direct.rays_traced, deep.rays_traced / 3);
  for (const Rgb& value : direct.indirect) EXPECT_EQ(value, (Rgb{0, 0, 0}));
}

TEST(Estimate, IsLinearInEmission) {
  scene::Scene scene = test::furnished_room();
  IrradianceOptions options;
  options.rays = 64;
  const Irradiance e = Room(scene).estimate(options);
  for (scene::Material& material : scene.materials) material.emission *= 16;
  const Irradiance brighter = Room(scene).estimate(options);
  for (size_t i = 0; i < e.direct.size(); ++i) {
    EXPECT_EQ(brighter.direct[i], e.direct[i] * 16) << "a power of two: exact";
    EXPECT_EQ(brighter.indirect[i], e.indirect[i] * 16);
  }
}

TEST(Groups, AreTheContributionsOfTheirLights) {
  scene::Scene scene = test::furnished_room();
  test::add_point_light(&scene, {3, 1.5f, 0.5f}, {0.5f, 1, 2});
  IrradianceOptions options;
  options.rays = 4096;
  const Irradiance all = Room(scene).estimate(options);
  ASSERT_EQ(all.groups, 3);
  // One group for all: the same paths, summed another way.
  scene::Scene merged = scene;
  for (auto& instance : merged.instances) {
    if (instance.light_group != scene::kNone) instance.light_group = 0;
  }
  merged.lights[0].light_group = 0;
  merged.light_groups.resize(1);
  const Irradiance one = Room(merged).estimate(options);
  ASSERT_EQ(one.groups, 1);
  for (int64_t i = 0; i < all.points; ++i) {
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(one.total(i)[c], all.total(i)[c], 1e-5 * one.total(i)[c]);
  }
  // Each light burning alone.
  for (int group = 0; group < 3; ++group) {
    scene::Scene alone = scene;
    for (const auto& instance : scene.instances) {
      if (instance.light_group == scene::kNone || instance.light_group == group) continue;
      alone.materials[alone.meshes[instance.mesh].material].emission = {};
    }
    if (group != 2) alone.lights.clear();
    const Irradiance e = Room(alone).estimate(options);
    for (int64_t i = 0; i < e.points; ++i) {
      const auto slot = static_cast<size_t>(group * e.points + i);
      const double error = std::sqrt(all.variance_total[i].x + e.variance_total[i].x);
      EXPECT_NEAR(all.direct[slot].x + all.indirect[slot].x, e.total(i).x, 4.5 * error)
          << "group " << group << " point " << i;
    }
  }
}

TEST(Groups, UnlitOnesAreNeverTraced) {
  scene::Scene scene = test::furnished_room();
  for (scene::Material& material : scene.materials) material.emission = {};
  const Irradiance e = Room(scene).estimate({});
  EXPECT_EQ(e.groups, 2);
  EXPECT_EQ(e.rays_traced, 0);
  for (const Rgb& value : e.direct) EXPECT_EQ(value, (Rgb{0, 0, 0}));
  EXPECT_EQ(e.variance, std::vector<float>(e.variance.size(), 0.0f));
}

TEST(Estimate, OneTriangleSceneAndNoPoints) {
  scene::Scene scene;
  const int material = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  scene::Mesh mesh;
  mesh.material = material;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  test::add_instance(&scene, mesh);
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> positions{{0.3f, 0.3f, 1}, {0.3f, 0.3f, 0}};
  const std::vector<Vec3> normals{{0, 0, -1}, {0, 0, 1}};
  const Irradiance e = estimate_irradiance(bvh, lights, positions, normals, {});
  EXPECT_GT(e.total(0).x, 0);
  EXPECT_EQ(e.total(1), (Rgb{0, 0, 0})) << "the triangle does not light itself";
  EXPECT_EQ(e.indirect_sum(0), (Rgb{0, 0, 0}));
  EXPECT_EQ(estimate_irradiance(bvh, lights, {}, {}, {}).points, 0);
}

TEST(Estimate, RoundsRaysUpToWholeStrata) {
  const Room room;
  for (const auto& [asked, given] : std::vector<std::pair<int, int64_t>>{
           {1, 2}, {2, 2}, {8, 8}, {9, 16}, {64, 64}, {65, 128}, {256, 256}, {1000, 1024}}) {
    IrradianceOptions options;
    options.rays = asked;
    EXPECT_EQ(room.estimate(options).rays, given) << asked;
  }
}

TEST(Estimate, NamesWhatItRefuses) {
  Room room;
  const Room other;
  const auto message = [](const std::string& text) {
    return ThrowsMessage<Error>(HasSubstr(text));
  };
  IrradianceOptions options;
  options.rays = 0;
  EXPECT_THAT([&] { room.estimate(options); }, message("rays"));
  options = {};
  options.max_depth = 0;
  EXPECT_THAT([&] { room.estimate(options); }, message("max_depth"));
  options = {};
  options.roulette_depth = 0;
  EXPECT_THAT([&] { room.estimate(options); }, message("roulette_depth"));
  options = {};
  EXPECT_THAT(
      [&] { estimate_irradiance(room.bvh, other.lights, room.positions, room.normals, options); },
      message("two scenes"));
  const Vec3 good = room.positions[3];
  room.positions[3].y = NAN;
  EXPECT_THAT([&] { room.estimate(options); }, message("position 3"));
  room.positions[3] = good;
  room.normals[2].x = INFINITY;
  EXPECT_THAT([&] { room.estimate(options); }, message("normal 2"));
  room.normals[2] = {0, 2, 0};
  EXPECT_THAT([&] { room.estimate(options); }, message("normal 2"));
  room.normals.pop_back();
  EXPECT_THAT([&] { room.estimate(options); }, message("4 normals"));
}

}  // namespace
}  // namespace lte::pathtrace
