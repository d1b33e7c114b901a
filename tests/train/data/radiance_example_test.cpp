#include "train/data/radiance_example.h"

#include <set>

#include <gtest/gtest.h>

#include "lte/base/half.h"
#include "lte/data/scene_sample.h"
#include "tests/train/support.h"
#include "train/data/example.h"

namespace lte::train {
namespace {

LightKeys radiance_keys() {
  LightKeys keys;
  keys.radiance = true;
  return keys;
}

TrainingScene scene_with_incident() {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(1);
  sample.name = "room";
  test::add_incident(&sample);
  data::write_scene_sample(dir / "room.safetensors", sample);
  return read_training_scene(dir / "room.safetensors", "room", radiance_keys());
}

Vec3 row(const at::Tensor& t, int64_t i) {
  const at::Tensor flat = t.reshape({-1, 3});
  return {flat[i][0].item<float>(), flat[i][1].item<float>(), flat[i][2].item<float>()};
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

/// A turned, mirrored room with permuted colors and gains.
Symmetry some_symmetry() {
  Symmetry symmetry = identity_symmetry(2);
  symmetry.rotation = {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}};
  symmetry.mirror = true;
  symmetry.channels = {2, 0, 1};
  symmetry.gains = {Rgb{2, 3, 4}, Rgb{0.5f, 1, 0}};
  return symmetry;
}

TEST(RadianceExample, IsTheFieldUnderTheSymmetryOverTheEmissionScale) {
  const TrainingScene scene = scene_with_incident();
  const data::IncidentField& field = scene.incident;
  ASSERT_TRUE(field.direct.empty()) << "the target is indirect";
  const Symmetry symmetry = some_symmetry();
  Rng rng(3);
  const RadianceExample all = make_radiance_example(scene, symmetry, {0.5, 0.25, 2}, {0, 0}, &rng);
  ASSERT_EQ(all.target.sizes(), (std::vector<int64_t>{60, 16, 3}));
  for (const int64_t point : {0, 17, 59}) {
    expect_near(row(all.queries.position, point),
                symmetry.space(field.position[static_cast<size_t>(point)]), 1e-6f);
    for (const int64_t cell : {0, 5, 15}) {
      const auto p = static_cast<size_t>(point), c = static_cast<size_t>(cell);
      const Vec3 local = field.direction[c], normal = field.normal[p], tangent = field.tangent[p];
      const Vec3 world = tangent * local.x + cross(normal, tangent) * local.y + normal * local.z;
      expect_near(row(all.directions, 16 * point + cell), symmetry.space(world), 1e-6f);
      // Channel c of the result comes from channels[c], with that one's gains.
      Vec3 expected{};
      for (int out = 0; out < 3; ++out) {
        const int in = symmetry.channels[static_cast<size_t>(out)];
        for (size_t g = 0; g < 2; ++g)
          expected[out] +=
              symmetry.gains[g][in] * field.scale[p] *
              to_float(field.indirect[((g * 60 + p) * 16 + c) * 3 + static_cast<size_t>(in)]);
      }
      expected = {kPi * 0.5f * expected.x, kPi * 0.25f * expected.y, kPi * 2 * expected.z};
      expect_near(row(all.target, 16 * point + cell), expected, 1e-5f * max_component(expected));
    }
  }
}

TEST(RadianceExample, DrawsDistinctPointsAndDirections) {
  const TrainingScene scene = scene_with_incident();
  Rng rng(3);
  const RadianceExample some =
      make_radiance_example(scene, identity_symmetry(2), {1, 1, 1}, {10, 6}, &rng);
  ASSERT_EQ(some.directions.sizes(), (std::vector<int64_t>{10, 6, 3}));
  for (int64_t point = 0; point < 10; ++point) {
    std::set<std::array<float, 3>> seen;
    const Vec3 normal = row(some.queries.normal, point);
    for (int64_t n = 0; n < 6; ++n) {
      const Vec3 direction = row(some.directions, 6 * point + n);
      EXPECT_GT(dot(direction, normal), 0);
      seen.insert({direction.x, direction.y, direction.z});
    }
    EXPECT_EQ(seen.size(), 6u);
  }
}

TEST(RadianceExample, ExamplesCarryItAndTheMetalOfTheirPoints) {
  const TrainingScene scene = scene_with_incident();
  Rng rng(3);
  QueryOptions options{20};
  options.radiance = {5, 4};
  const std::vector<int64_t> rows = data::draw_scene_rows(scene.light, 90, &rng);
  const Example example = make_example(scene, identity_symmetry(2), rows, options, &rng);
  ASSERT_TRUE(example.radiance.defined());
  EXPECT_EQ(example.radiance.target.sizes(), (std::vector<int64_t>{5, 4, 3}));
  ASSERT_TRUE(example.points.gloss.defined());
  for (size_t i = 0; i < rows.size(); ++i) {
    const bool metal = rows[i] % 3 == 0;
    EXPECT_EQ(example.points.gloss[static_cast<int64_t>(i)][0].item<float>(), metal ? 1 : 0);
    EXPECT_EQ(example.points.gloss[static_cast<int64_t>(i)][1].item<float>(), metal ? 0.2f : 1);
  }
}

TEST(RadianceExample, AFileWithoutIncidentRadianceIsRefusedByName) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(1);
  sample.name = "room";
  data::write_scene_sample(dir / "room.safetensors", sample);
  test::expect_error(
      [&] { read_training_scene(dir / "room.safetensors", "room", radiance_keys()); },
      {(dir / "room.safetensors").string(), "no incident radiance", "incident.points"});
}

}  // namespace
}  // namespace lte::train
