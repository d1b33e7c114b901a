#include "datagen/bake/bake.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datagen/boxes/room.h"
#include "lte/base/file.h"
#include "lte/base/parallel.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"
#include "tests/support/every_light.h"
#include "tests/support/light_reference.h"

namespace lte::datagen::test {
namespace {

using data::test::error_of;
using ::testing::HasSubstr;

class Bake : public data::test::Folder {
 protected:
  static scene::Scene room() {
    boxes::RoomConfig config;
    config.texture_sizes = {8};
    return boxes::generate_room(config, 3, "room").scene;
  }
  std::string bytes(const data::SceneSample& sample) const {
    data::write_scene_sample(folder_ / "sample.safetensors", sample);
    return read_file(folder_ / "sample.safetensors");
  }
};

TEST_F(Bake, ViewsTakeTheGivenCamerasFirst) {
  BakeOptions options = tiny_bake();
  options.views.count = 3;
  // From the middle of the unit cube to opposite walls.
  const auto towards = [](float x) {
    return scene::Camera{"", {0.5f, 0.5f, 0.5f}, {x, 0.5f, 0.5f}, {0, 1, 0}, 30};
  };
  options.view_cameras = {towards(0), towards(1)};
  int64_t rays = 0;
  const data::SceneSample sample = bake_scene(furnace(2, 0.5f), options, false, &rays);
  ASSERT_EQ(sample.views.size(), 3u);
  std::vector<float> walls;
  for (int v = 0; v < 2; ++v) {
    const data::View& view = sample.views[static_cast<size_t>(v)];
    for (const Vec3& p : view.position) EXPECT_NEAR(p.x, view.position[0].x, 1e-5f);
    walls.push_back(std::round(view.position[0].x));
  }
  EXPECT_THAT(walls, ::testing::UnorderedElementsAre(0.0f, 1.0f));
  EXPECT_GE(rays, (48 + 2 * 48) * (8 + 64));
}

TEST_F(Bake, FurnaceGivesTheClosedForm) {
  BakeOptions options = tiny_bake();
  options.max_depth = 3;
  options.rays = 1024;
  options.views.rays = 1024;
  const data::SceneSample sample = bake_scene(furnace(2, 0.5f), options, false);
  ASSERT_EQ(sample.light_groups, 1);
  const float direct = furnace_irradiance(2, 0.5f, 0, 0),
              indirect = furnace_irradiance(2, 0.5f, 1, 2);
  const auto check = [&](const Rgb& d, const Rgb& i) {
    EXPECT_NEAR(d.x, direct, 0.03f * direct);
    EXPECT_NEAR(i.y, indirect, 0.03f * indirect);
  };
  for (size_t i = 0; i < sample.direct.size(); ++i) check(sample.direct[i], sample.indirect[i]);
  double path_traced = 0;
  for (const Rgb& value : sample.path_traced_64)
    path_traced += value.x / static_cast<double>(sample.path_traced_64.size());
  EXPECT_NEAR(path_traced, indirect, 0.03 * indirect);
  ASSERT_EQ(sample.views.size(), 1u);
  for (size_t i = 0; i < sample.views[0].mask.size(); ++i) {
    ASSERT_EQ(sample.views[0].mask[i], 1);
    check(sample.views[0].direct[i], sample.views[0].indirect[i]);
  }
}

TEST_F(Bake, HasTheSizesAskedForAndPassesTheReader) {
  const BakeOptions options = tiny_bake();
  const scene::Scene scene = room();
  const auto path = folder_ / "room.safetensors";
  data::write_scene_sample(path, bake_scene(scene, options, false));
  const data::SceneSample sample = data::read_scene_sample(path);
  EXPECT_EQ(sample.name, "room");
  EXPECT_EQ(sample.scene_points(), options.scene_points);
  EXPECT_EQ(sample.query_points(), options.query_points);
  EXPECT_EQ(sample.light_groups, static_cast<int64_t>(scene.light_groups.size()));
  EXPECT_EQ(sample.rays, options.rays);
  EXPECT_EQ(sample.seed, options.seed);
  EXPECT_EQ(sample.bounds_high, scene.bounds().high);
  ASSERT_EQ(sample.views.size(), 1u);
  EXPECT_EQ(sample.views[0].width, 8);
  EXPECT_EQ(sample.views[0].height, 6);
}

TEST_F(Bake, EveryLightGroupHasScenePoints) {
  const scene::Scene scene = room();
  const data::SceneSample sample = bake_scene(scene, tiny_bake(), false);
  std::vector<int> points(scene.light_groups.size());
  for (size_t i = 0; i < sample.scene_light.size(); ++i) {
    const int group = sample.scene_light[i];
    EXPECT_EQ(group >= 0, max_component(sample.scene_emission[i]) > 0);
    if (group >= 0) ++points[static_cast<size_t>(group)];
  }
  for (const int count : points) EXPECT_GT(count, 0);
}

TEST_F(Bake, SameBytesWhateverTheThreadsAndOthersForAnotherSeed) {
  const scene::Scene scene = room();
  BakeOptions options = tiny_bake();
  set_num_threads(1);
  const std::string one = bytes(bake_scene(scene, options, false));
  set_num_threads(3);
  const std::string three = bytes(bake_scene(scene, options, false));
  set_num_threads(0);
  EXPECT_EQ(one, three);
  options.seed = 2;
  EXPECT_NE(one, bytes(bake_scene(scene, options, false)));
}

TEST_F(Bake, PathTraced64IsIndependentOfTheReference) {
  BakeOptions options = tiny_bake();
  options.rays = 64;
  const data::SceneSample sample = bake_scene(room(), options, false);
  ASSERT_EQ(sample.path_traced_64.size(), sample.query_position.size());
  size_t equal = 0, lit = 0;
  for (size_t i = 0; i < sample.path_traced_64.size(); ++i) {
    Rgb sum;
    for (int64_t g = 0; g < sample.light_groups; ++g)
      sum += sample.indirect[static_cast<size_t>(g) * sample.query_position.size() + i];
    if (sum.x == 0) continue;
    ++lit;
    equal += sum == sample.path_traced_64[i];
  }
  EXPECT_GT(lit, 20u);
  EXPECT_EQ(equal, 0u);
}

/// Mean squared difference of two pictures, and of their means, over color.
double mean_square(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const Rgb d = a[i] - b[i];
    sum += dot(d, d) / (3 * static_cast<double>(a.size()));
  }
  return sum;
}
double mean_value(const std::vector<Rgb>& values) {
  double sum = 0;
  for (const Rgb& v : values) sum += (v.x + v.y + v.z) / (3 * static_cast<double>(values.size()));
  return sum;
}

TEST_F(Bake, PicturesOfFewPathsHaveTheErrorOfTheirPathsAndNoBias) {
  BakeOptions options = tiny_bake();
  options.views = {1, 48, 36, 512};
  const data::SceneSample sample = bake_scene(room(), options, false);
  const data::View& view = sample.views.at(0);
  const size_t pixels = view.mask.size();
  std::vector<Rgb> reference(pixels);
  double noise = 0;
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t g = 0; g < static_cast<size_t>(sample.light_groups); ++g)
      reference[i] += view.indirect[g * pixels + i];
    noise += view.variance[i] / static_cast<double>(pixels);
  }
  const double at_64 = mean_square(view.path_traced_64, reference) - noise;
  ASSERT_GT(at_64, 4 * noise);
  for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
    const std::vector<Rgb>& picture = view.path_traced_few[i];
    ASSERT_EQ(picture.size(), pixels);
    const double paths = data::kFewPaths[i];
    const double error = mean_square(picture, reference) - noise;
    // Stratification gives the 64 somewhat less than 1/64 of the variance of one path.
    EXPECT_GT(error * paths / (at_64 * 64), 0.75) << paths << " paths";
    EXPECT_LT(error * paths / (at_64 * 64), 2) << paths << " paths";
    EXPECT_NEAR(mean_value(picture), mean_value(reference),
                4.5 * std::sqrt(error / static_cast<double>(pixels)));
    EXPECT_NE(picture, view.path_traced_64);
  }
}

TEST_F(Bake, PicturesOfFewPathsLeaveOtherTensorsAsTheyWere) {
  BakeOptions options = tiny_bake();
  const data::SceneSample with = bake_scene(room(), options, false);
  options.path_tracing_64 = false;
  data::SceneSample without = bake_scene(room(), options, false);
  for (const auto& picture : without.views.at(0).path_traced_few) EXPECT_TRUE(picture.empty());
  without.path_traced_64 = with.path_traced_64;
  without.views[0].path_traced_64 = with.views.at(0).path_traced_64;
  without.views[0].path_traced_few = with.views[0].path_traced_few;
  EXPECT_EQ(bytes(with), bytes(without));
}

TEST_F(Bake, ViewsOfOpenScenesAreZeroOutsideTheMask) {
  scene::Scene scene = furnace(1, 0.5f);
  scene.meshes.clear();
  const int mesh =
      add_meshes(&scene, "floor", {{{-1, 0, -1}, {1, 0.1f, 1}, 0, kAllFaces, 0, false}})[0];
  scene.instances = {{mesh, {}, 0}};
  const data::SceneSample sample = bake_scene(scene, tiny_bake(), false);
  const data::View& view = sample.views.at(0);
  size_t background = 0;
  for (size_t i = 0; i < view.mask.size(); ++i) {
    if (view.mask[i]) continue;
    ++background;
    EXPECT_EQ(view.position[i], Vec3{});
    EXPECT_EQ(view.direct[i], Rgb{});
    EXPECT_EQ(view.path_traced_64[i], Rgb{});
    for (const auto& picture : view.path_traced_few) EXPECT_EQ(picture[i], Rgb{});
  }
  EXPECT_GT(background, 0u);
  EXPECT_LT(background, view.mask.size());
}

TEST_F(Bake, PrunesPointsThatLightCannotReachUnlessToldNotTo) {
  BakeOptions options = tiny_bake();
  options.query_points = 200;
  options.path_tracing_64 = false;
  options.views.count = 0;
  const auto dark = [](const data::SceneSample& sample) {
    const size_t N = sample.query_position.size();
    size_t count = 0;
    for (size_t i = 0; i < N; ++i) {
      bool lit = false;
      for (size_t k = i; k < sample.direct.size(); k += N)
        lit = lit || max_component(sample.direct[k] + sample.indirect[k]) > 0;
      count += lit ? 0 : 1;
    }
    return count;
  };
  options.prune = true;
  const data::SceneSample pruned = bake_scene(room(), options, false);
  EXPECT_GT(pruned.pruned_query_points, 0);
  EXPECT_EQ(pruned.query_points(), 200);
  EXPECT_EQ(pruned.scene_points(), options.scene_points);
  data::write_scene_sample(folder_ / "a.safetensors", pruned);
  EXPECT_EQ(data::read_scene_sample(folder_ / "a.safetensors").pruned_query_points,
            pruned.pruned_query_points);
  options.prune = false;
  const data::SceneSample whole = bake_scene(room(), options, false);
  EXPECT_EQ(whole.pruned_query_points, 0);
  EXPECT_EQ(whole.query_points(), 200);
  EXPECT_GT(dark(whole), dark(pruned) + 5);
}

TEST_F(Bake, EveryKindOfLightIsInTheScenePoints) {
  BakeOptions options = tiny_bake();
  options.scene_points = 500;
  options.path_tracing_64 = false;
  options.views.count = 0;
  for (const lte::test::LitScene& lit : lte::test::scenes_of_every_light()) {
    for (const bool prune : {false, true}) {
      options.prune = prune;
      const data::SceneSample sample = bake_scene(lit.scene, options, false);
      EXPECT_EQ(sample.scene_points(), 500);
      std::vector<double> strength(lit.strength.size(), 0.0);
      std::vector<float> direct(lit.strength.size(), 0.0f);
      const size_t M = sample.scene_position.size();
      for (size_t i = 0; i < M; ++i) {
        if (sample.scene_light[i] != scene::kNone)
          strength[static_cast<size_t>(sample.scene_light[i])] +=
              double{sample.scene_emission[i].x} * sample.scene_area[i];
        for (size_t g = 0; g < direct.size(); ++g) {
          const float light = max_component(sample.scene_direct[g * M + i]);
          direct[g] = std::max(direct[g], light);
          if (max_component(sample.scene_emission[i]) > 0) {
            EXPECT_EQ(light, 0) << lit.light;
          }
        }
      }
      for (size_t g = 0; g < strength.size(); ++g) {
        const double tolerance =
            std::max(0.2 * lit.strength[g] * (lit.tolerance > 0.1 ? 1 : 0), 1e-4 * lit.strength[g]);
        EXPECT_NEAR(strength[g], lit.strength[g], tolerance) << lit.light << ", prune " << prune;
        EXPECT_GT(direct[g], 0) << lit.light << ", prune " << prune;
      }
    }
  }
}

TEST_F(Bake, TargetErrorDecidesThePathsAndIsRecorded) {
  BakeOptions options = tiny_bake();
  options.target_error = 0.1;
  options.max_rays = 256;
  data::write_scene_sample(folder_ / "a.safetensors", bake_scene(room(), options, false));
  const data::SceneSample sample = data::read_scene_sample(folder_ / "a.safetensors");
  EXPECT_EQ(sample.target_error, 0.1);
  ASSERT_EQ(sample.query_rays.size(), sample.query_position.size());
  double mean = 0;
  for (const int32_t rays : sample.query_rays) {
    EXPECT_GE(rays, 64);
    EXPECT_LE(rays, 256);
    mean += rays / static_cast<double>(sample.query_rays.size());
  }
  EXPECT_EQ(sample.rays, std::llround(mean));
  options.target_error = 0;
  const data::SceneSample fixed = bake_scene(room(), options, false);
  EXPECT_TRUE(fixed.query_rays.empty());
  EXPECT_EQ(fixed.rays, options.rays);
}

/// The cells of a point sum to its irradiance, and the file keeps them.
TEST_F(Bake, IncidentRadianceSumsToIrradiance) {
  BakeOptions options = tiny_bake();
  options.incident = {3, 8, 32};
  options.max_depth = 3;
  const data::SceneSample baked = bake_scene(furnace(3000, 0.5f), options, false);
  bytes(baked);
  const data::SceneSample sample = data::read_scene_sample(folder_ / "sample.safetensors");
  const data::IncidentField& field = sample.incident;
  ASSERT_EQ(field.points(), 3);
  ASSERT_EQ(field.bins, 8);
  EXPECT_TRUE(sample.scene_metallic.empty());
  double turn = 0;
  for (const float pdf : field.pdf) turn += 1 / (64 * double{pdf});
  EXPECT_NEAR(turn, 2 * M_PI, 1e-4);
  for (size_t i = 0; i < 3; ++i) {
    double direct = 0, indirect = 0;
    for (size_t k = 0; k < 64; ++k) {
      const size_t at = (i * 64 + k) * 3;
      direct += kPi / 64 * field.scale[i] * to_float(field.direct[at]);
      indirect += kPi / 64 * field.scale[i] * to_float(field.indirect[at]);
    }
    EXPECT_NEAR(direct, furnace_irradiance(3000, 0.5f, 0, 0), 5e-4 * direct);
    EXPECT_NEAR(indirect, furnace_irradiance(3000, 0.5f, 1, 2), 0.03 * indirect);
  }
}

TEST_F(Bake, MetalIsRecordedAndOtherTensorsStay) {
  scene::Scene scene = room();
  const data::SceneSample matt = bake_scene(scene, tiny_bake(), false);
  EXPECT_TRUE(matt.scene_metallic.empty());
  EXPECT_TRUE(matt.incident.empty());
  scene.materials[0].metallic = 1;
  scene.materials[0].roughness = 0.25f;
  const data::SceneSample metal = bake_scene(scene, tiny_bake(), false);
  ASSERT_EQ(metal.scene_metallic.size(), metal.scene_position.size());
  EXPECT_EQ(metal.scene_position, matt.scene_position);
  EXPECT_EQ(metal.query_position, matt.query_position);
  EXPECT_NE(metal.indirect, matt.indirect);
  int found = 0;
  for (size_t i = 0; i < metal.scene_metallic.size(); ++i)
    found += metal.scene_metallic[i] == 1 && metal.scene_roughness[i] == 0.25f;
  EXPECT_GT(found, 0);
  EXPECT_LT(found, 64);
}

/// Light on scene points is that on query points, estimated apart.
TEST_F(Bake, ScenePointsCarryTheirDirectLight) {
  BakeOptions options = tiny_bake();
  options.scene_points = options.query_points = 4000;
  options.emissive_share = 0;
  const data::SceneSample sample = bake_scene(room(), options, false);
  const auto M = static_cast<size_t>(sample.scene_points()),
             G = static_cast<size_t>(sample.light_groups);
  ASSERT_EQ(sample.scene_direct.size(), G * M);
  const auto mean = [](const std::vector<Rgb>& values) {
    double sum = 0;
    for (const Rgb& value : values) sum += value.x + value.y + value.z;
    return sum / static_cast<double>(values.size());
  };
  EXPECT_GT(mean(sample.direct), 0);
  EXPECT_NEAR(mean(sample.scene_direct), mean(sample.direct), 0.1 * mean(sample.direct));
  for (size_t i = 0; i < M; ++i) {
    const bool luminaire = max_component(sample.scene_emission[i]) > 0;
    EXPECT_TRUE(!luminaire || sample.scene_direct[i] == Rgb{}) << i;
  }
}

/// What is stored at each scene point is the light on both sides of its surface, luminaires apart.
TEST_F(Bake, ScenePointsCarryTheirLightPointByPoint) {
  BakeOptions options = tiny_bake();
  options.light_paths = 4096;
  options.max_depth = 4;
  const scene::Scene scene = room();
  const data::SceneSample sample = bake_scene(scene, options, false);
  const auto M = static_cast<size_t>(sample.scene_points());
  ASSERT_EQ(sample.scene_indirect.size(), sample.scene_direct.size());
  std::vector<Vec3> position, normal;
  std::vector<Rgb> direct, indirect;
  for (size_t i = 0; i < M; ++i) {
    Rgb sums[2];
    for (size_t at = i; at < sample.scene_direct.size(); at += M) {
      sums[0] += sample.scene_direct[at];
      sums[1] += sample.scene_indirect[at];
    }
    if (max_component(sample.scene_emission[i]) > 0) {
      EXPECT_TRUE(sums[0] == Rgb{} && sums[1] == Rgb{}) << i;
      continue;
    }
    position.push_back(sample.scene_position[i]);
    normal.push_back(sample.scene_normal[i]);
    direct.push_back(sums[0]);
    indirect.push_back(sums[1]);
  }
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  pathtrace::IrradianceOptions tracing;
  tracing.max_depth = options.max_depth;
  tracing.rays = options.light_paths;
  tracing.seed = 1000;
  const auto own = lte::test::two_sided_light(bvh, lights, position, normal, tracing);
  tracing.rays = 1 << 14;
  tracing.seed = 2000;
  tracing.sampling = pathtrace::Sampling::Random;
  const auto reference = lte::test::two_sided_light(bvh, lights, position, normal, tracing);
  lte::test::expect_within_error(direct, own.direct, reference.direct, "scene_direct");
  lte::test::expect_within_error(indirect, own.indirect, reference.indirect, "scene_indirect");
}

TEST_F(Bake, SwitchesLeaveTensorsOut) {
  BakeOptions options = tiny_bake();
  options.path_tracing_64 = false;
  options.views.count = 0;
  const data::SceneSample sample = bake_scene(furnace(1, 0.5f), options, false);
  EXPECT_TRUE(sample.path_traced_64.empty());
  EXPECT_TRUE(sample.views.empty());
}

TEST_F(Bake, OptionsOutOfRangeAreNamed) {
  const auto error = [](auto change) {
    BakeOptions options = tiny_bake();
    change(&options);
    return error_of([&] { check_bake_options(options); });
  };
  EXPECT_EQ(error([](BakeOptions*) {}), "");
  EXPECT_THAT(error([](BakeOptions* o) { o->scene_points = 0; }), HasSubstr("scene_points"));
  EXPECT_THAT(error([](BakeOptions* o) { o->query_points = -1; }), HasSubstr("query_points"));
  EXPECT_THAT(error([](BakeOptions* o) { o->rays = 0; }), HasSubstr("rays"));
  EXPECT_THAT(error([](BakeOptions* o) { o->target_error = -1; }), HasSubstr("target_error"));
  EXPECT_THAT(error([](BakeOptions* o) { o->min_rays = 1; }), HasSubstr("min_rays"));
  EXPECT_THAT(error([](BakeOptions* o) { o->max_rays = 8; }), HasSubstr("max_rays"));
  EXPECT_THAT(error([](BakeOptions* o) { o->max_depth = 0; }), HasSubstr("max_depth"));
  EXPECT_THAT(error([](BakeOptions* o) { o->emissive_share = std::nan(""); }),
              HasSubstr("emissive_share"));
  EXPECT_THAT(error([](BakeOptions* o) { o->views.width = 0; }), HasSubstr("views.width"));
  EXPECT_THAT(error([](BakeOptions* o) { o->views.rays = 0; }), HasSubstr("views.rays"));
}

}  // namespace
}  // namespace lte::datagen::test
