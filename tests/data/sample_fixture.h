// A small valid scene sample, and a folder of its own for each test.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/data/scene_sample.h"
#include "tests/support/temp_dir.h"

namespace lte::data::test {

class Folder : public ::testing::Test {
 protected:
  const lte::test::TempDir own_;
  const std::filesystem::path folder_ = own_.path();
};

/// A folder with a place for one sample.
class SceneSampleFile : public Folder {
 protected:
  std::filesystem::path path() const { return folder_ / "room.safetensors"; }
};

/// The line with which `body` fails; "" if it does not.
inline std::string error_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline std::vector<Vec3> random_vectors(Rng* rng, size_t count, float low, float high) {
  std::vector<Vec3> out(count);
  for (Vec3& v : out) {
    v.x = rng->uniform(low, high);
    v.y = rng->uniform(low, high);
    v.z = rng->uniform(low, high);
  }
  return out;
}

inline std::vector<Vec3> random_units(Rng* rng, size_t count) {
  std::vector<Vec3> out = random_vectors(rng, count, 0.1f, 1.0f);
  for (Vec3& v : out) v = normalize(v);
  return out;
}

inline View make_view(Rng* rng, int width, int height, size_t groups) {
  View view;
  view.width = width;
  view.height = height;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  view.position = random_vectors(rng, pixels, -2, 2);
  view.normal = random_units(rng, pixels);
  view.albedo = random_vectors(rng, pixels, 0, 1);
  view.mask.assign(pixels, 1);
  view.direct = random_vectors(rng, groups * pixels, 0, 5);
  view.indirect = random_vectors(rng, groups * pixels, 0, 5);
  view.variance.assign(pixels, 0.25f);
  view.path_traced_64 = random_vectors(rng, pixels, 0, 5);
  view.mask[1] = 0;  // one background pixel
  view.position[1] = view.normal[1] = view.albedo[1] = {};
  for (size_t g = 0; g < groups; ++g)
    view.direct[g * pixels + 1] = view.indirect[g * pixels + 1] = {};
  view.path_traced_64[1] = {};
  return view;
}

inline IncidentField make_incident(Rng* rng, size_t points, int bins, size_t groups) {
  IncidentField field;
  field.bins = bins;
  field.samples = 16;
  const size_t cells = static_cast<size_t>(bins) * static_cast<size_t>(bins);
  field.position = random_vectors(rng, points, -2, 2);
  field.normal.assign(points, {0, 1, 0});
  field.tangent.assign(points, {0.6f, 0, 0.8f});
  field.albedo = random_vectors(rng, points, 0, 1);
  field.metallic.assign(points, 1);
  field.roughness.assign(points, 0.3f);
  field.scale.assign(points, 0.25f);
  for (size_t i = 0; i < groups * points * cells * 3; ++i) {
    field.direct.push_back(to_half(rng->uniform(0, 60000)));
    field.indirect.push_back(to_half(rng->uniform(0, 1)));
  }
  field.direction = random_units(rng, cells);
  field.pdf.assign(cells, 0.2f);
  return field;
}

inline SceneSample make_sample(int64_t scene_points = 8, int64_t query_points = 6,
                               int64_t groups = 2) {
  Rng rng(11);
  const auto M = static_cast<size_t>(scene_points), N = static_cast<size_t>(query_points);
  const auto G = static_cast<size_t>(groups);
  SceneSample sample;
  sample.name = "room";
  sample.geometry = "00c0ffee00c0ffee";
  sample.scene_position = random_vectors(&rng, M, -2, 2);
  sample.scene_normal = random_units(&rng, M);
  sample.scene_albedo = random_vectors(&rng, M, 0, 1);
  sample.scene_emission = random_vectors(&rng, M, 0, 9);
  sample.scene_area.assign(M, 0.5f);
  sample.scene_light.assign(M, -1);
  if (G > 0) sample.scene_light[0] = static_cast<int32_t>(G) - 1;
  sample.query_position = random_vectors(&rng, N, -2, 2);
  sample.query_normal = random_units(&rng, N);
  sample.query_albedo = random_vectors(&rng, N, 0, 1);
  sample.light_groups = groups;
  sample.direct = random_vectors(&rng, G * N, 0, 5);
  sample.indirect = random_vectors(&rng, G * N, 0, 5);
  sample.variance.assign(N, 0.125f);
  sample.path_traced_64 = random_vectors(&rng, N, 0, 5);
  sample.views.push_back(make_view(&rng, 4, 3, G));
  sample.seed = 0xffffffffffffffffULL;
  sample.rays = 256;
  sample.max_depth = 5;
  sample.bounds_low = {-2.1f, -0.1f, 1.0f / 3};
  sample.bounds_high = {2, 3, 4};
  return sample;
}

inline void expect_equal(const View& a, const View& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.albedo, b.albedo);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.path_traced_64, b.path_traced_64);
}

inline void expect_equal(const SceneSample& a, const SceneSample& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.geometry, b.geometry);
  EXPECT_EQ(a.scene_position, b.scene_position);
  EXPECT_EQ(a.scene_normal, b.scene_normal);
  EXPECT_EQ(a.scene_albedo, b.scene_albedo);
  EXPECT_EQ(a.scene_emission, b.scene_emission);
  EXPECT_EQ(a.scene_area, b.scene_area);
  EXPECT_EQ(a.scene_light, b.scene_light);
  EXPECT_EQ(a.query_position, b.query_position);
  EXPECT_EQ(a.query_normal, b.query_normal);
  EXPECT_EQ(a.query_albedo, b.query_albedo);
  EXPECT_EQ(a.light_groups, b.light_groups);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.query_rays, b.query_rays);
  EXPECT_EQ(a.path_traced_64, b.path_traced_64);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.target_error, b.target_error);
  EXPECT_EQ(a.pruned_scene_points, b.pruned_scene_points);
  EXPECT_EQ(a.pruned_query_points, b.pruned_query_points);
  EXPECT_EQ(a.max_depth, b.max_depth);
  EXPECT_EQ(a.bounds_low, b.bounds_low);
  EXPECT_EQ(a.bounds_high, b.bounds_high);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (size_t k = 0; k < a.views.size(); ++k) expect_equal(a.views[k], b.views[k]);
}

}  // namespace lte::data::test
