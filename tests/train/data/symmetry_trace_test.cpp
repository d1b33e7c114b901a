// The symmetries of the augmentation against the path tracer: trace a scene, transform the scene
// and trace it again; the second must be what the augmentation makes of the first.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "lte/pathtrace/irradiance.h"
#include "tests/support/scenes.h"
#include "tests/train/support.h"
#include "tests/train/tensors.h"
#include "train/data/augment.h"
#include "train/data/example.h"

namespace lte::train {
namespace {

constexpr int kSeeds = 24;  ///< independent estimates, whose spread is the standard error
constexpr int kPaths = 1024;

/// On floor, walls, ceiling and the top of a box of test::furnished_room().
const std::vector<Vec3> kPositions = {{2, 0, 1},       {0, 1.2f, 2}, {0.9f, 1.1f, 1},   {4, 2, 1},
                                      {1.9f, 2.5f, 2}, {3.5f, 1, 0}, {2.8f, 0.7f, 1.9f}};
const std::vector<Vec3> kNormals = {{0, 1, 0},  {1, 0, 0}, {0, 1, 0}, {-1, 0, 0},
                                    {0, -1, 0}, {0, 0, 1}, {0, 1, 0}};

/// [seed][group, point] of the target.
using Traces = std::vector<std::vector<Rgb>>;

Traces trace(const scene::Scene& scene, const std::vector<Vec3>& positions,
             const std::vector<Vec3>& normals, const std::string& target, uint64_t first_seed) {
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  Traces traces;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    pathtrace::IrradianceOptions options;
    options.rays = kPaths;
    options.seed = first_seed + seed;
    const auto traced = pathtrace::estimate_irradiance(bvh, lights, positions, normals, options);
    traces.push_back(target == "direct" ? traced.direct : traced.indirect);
  }
  return traces;
}

/// The scene as the symmetry maps it.
scene::Scene transformed(scene::Scene scene, const Symmetry& symmetry) {
  Affine map;
  for (int column = 0; column < 3; ++column) {
    Vec3 axis{};
    axis[column] = 1;
    const Vec3 image = symmetry.space(axis);
    for (int row = 0; row < 3; ++row) map.m[row][column] = image[row];
  }
  for (scene::Instance& instance : scene.instances) {
    instance.to_world = map * instance.to_world;
    scene::Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (instance.light_group >= 0)  // each lamp of this room has a material of its own
      material.emission = symmetry.light(material.emission, instance.light_group);
  }
  for (scene::Material& material : scene.materials)
    material.base_color = symmetry.color(material.base_color);
  return scene;
}

/// What the trainer makes of baked values under the symmetry: irradiance at the points, [N].
std::vector<Rgb> augmented(const scene::Scene& room, const std::vector<Rgb>& baked,
                           const Symmetry& symmetry) {
  TrainingScene scene;
  scene.query_position = kPositions;
  scene.query_normal = kNormals;
  scene.query_albedo.assign(kPositions.size(), {0.5f, 0.5f, 0.5f});
  scene.light_groups = static_cast<int64_t>(room.light_groups.size());
  scene.target = baked;
  for (const scene::Instance& instance : room.instances) {
    scene.position.push_back({0, 0, 0});
    scene.normal.push_back({0, 1, 0});
    scene.albedo.push_back({0.5f, 0.5f, 0.5f});
    scene.emission.push_back(room.materials[room.meshes[instance.mesh].material].emission);
    scene.area.push_back(1);
    scene.light.push_back(instance.light_group);
  }
  Rng rng(1);
  const Example example = make_example(scene, symmetry, 0, 0, &rng);
  const at::Tensor radiance = nn::emission_scale(example.points).to(at::kFloat);
  return test::triples_of(example.target * radiance);
}

struct Estimate {
  std::vector<double> mean, error;  ///< [N * 3]
};

Estimate estimate(const std::vector<std::vector<Rgb>>& samples) {
  const size_t values = samples[0].size() * 3;
  Estimate out{std::vector<double>(values, 0.0), std::vector<double>(values, 0.0)};
  const auto count = static_cast<double>(samples.size());
  for (size_t i = 0; i < values; ++i) {
    double sum = 0, square = 0;
    for (const auto& sample : samples) sum += sample[i / 3][static_cast<int>(i % 3)];
    for (const auto& sample : samples)
      square += std::pow(sample[i / 3][static_cast<int>(i % 3)] - sum / count, 2);
    out.mean[i] = sum / count;
    out.error[i] = std::sqrt(square / (count * (count - 1)));
  }
  return out;
}

/// Largest difference in standard errors.
double apart(const Estimate& a, const Estimate& b) {
  double most = 0;
  for (size_t i = 0; i < a.mean.size(); ++i) {
    const double difference = std::abs(a.mean[i] - b.mean[i]);
    // No lamp shines on the ceiling: both are exactly black.
    if (difference > 0) most = std::max(most, difference / std::hypot(a.error[i], b.error[i]));
  }
  return most;
}

Estimate sum_of_groups(const Traces& traces) {
  std::vector<std::vector<Rgb>> sums;
  for (const std::vector<Rgb>& trace : traces) {
    std::vector<Rgb> sum(kPositions.size());
    for (size_t i = 0; i < trace.size(); ++i) sum[i % sum.size()] += trace[i];
    sums.push_back(std::move(sum));
  }
  return estimate(sums);
}

/// @param symmetry  what is put to the test
/// @param other  what the test has to tell from it
void expect_symmetry(const Symmetry& symmetry, const Symmetry& other, const std::string& target) {
  SCOPED_TRACE(target);
  const scene::Scene room = test::furnished_room();
  std::vector<Vec3> positions = kPositions, normals = kNormals;
  for (Vec3& position : positions) position = symmetry.space(position);
  for (Vec3& normal : normals) normal = symmetry.space(normal);
  const Estimate again =
      sum_of_groups(trace(transformed(room, symmetry), positions, normals, target, 1000));
  const Traces baked = trace(room, kPositions, kNormals, target, 1);
  std::vector<std::vector<Rgb>> made, made_otherwise;
  for (const std::vector<Rgb>& values : baked) {
    made.push_back(augmented(room, values, symmetry));
    made_otherwise.push_back(augmented(room, values, other));
  }
  const Estimate expected = estimate(made);
  for (size_t i = 0; i < expected.mean.size(); ++i)
    EXPECT_LE(expected.error[i], 0.02 * expected.mean[i]) << "too noisy to tell, value " << i;
  EXPECT_LT(apart(again, expected), 4.5);
  EXPECT_GT(apart(again, estimate(made_otherwise)), 30) << "the test tells nothing";
}

Symmetry plain() { return identity_symmetry(2); }

/// Moves points alone, so that baked values stay: what tells such a symmetry from none is a dimmed
/// lamp beside it.
Symmetry dimmed(Symmetry symmetry) {
  symmetry.gains[1] = symmetry.gains[1] * 0.25f;
  return symmetry;
}

Symmetry turned() {
  AugmentConfig config{Rotation::Vertical, false, false, 1, 1};
  Rng rng(21);
  return draw_symmetry(config, 2, {}, 1e9, &rng);
}

class SymmetryOfTransport : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Targets, SymmetryOfTransport, testing::Values("direct", "indirect"));

TEST_P(SymmetryOfTransport, RotationAboutTheVertical) {
  expect_symmetry(turned(), dimmed(turned()), GetParam());
}

TEST_P(SymmetryOfTransport, Mirror) {
  Symmetry symmetry = plain();
  symmetry.mirror = true;
  expect_symmetry(symmetry, dimmed(symmetry), GetParam());
}

TEST_P(SymmetryOfTransport, PermutedChannels) {
  Symmetry symmetry = plain();
  symmetry.channels = {2, 0, 1};
  Symmetry other = plain();
  other.channels = {1, 2, 0};  // the inverse: the easiest to mistake it for
  expect_symmetry(symmetry, other, GetParam());
}

TEST_P(SymmetryOfTransport, GainsByGroupAndChannel) {
  Symmetry symmetry = plain(), other = plain();
  symmetry.gains = {{3, 0.5f, 1}, {0.2f, 2, 4}};
  other.gains = {{0.2f, 2, 4}, {3, 0.5f, 1}};
  expect_symmetry(symmetry, other, GetParam());
}

TEST_P(SymmetryOfTransport, AllTogether) {
  const AugmentConfig config;
  Rng rng(5);
  Symmetry symmetry = draw_symmetry(config, 2, {}, 1e9, &rng);
  while (!symmetry.mirror || symmetry.channels == std::array<int, 3>{0, 1, 2})
    symmetry = draw_symmetry(config, 2, {}, 1e9, &rng);
  expect_symmetry(symmetry, plain(), GetParam());
}

}  // namespace
}  // namespace lte::train
