#include "train/data/augment.h"

#include <array>
#include <cmath>
#include <set>

#include "tests/train/support.h"
#include "tests/train/tensors.h"
#include "train/data/example.h"

namespace lte::train {
namespace {

constexpr double kNoLimit = 1e9;

Bounds room() {
  Bounds bounds;
  bounds.extend({0, 0, 0});
  bounds.extend({4, 3, 5});
  return bounds;
}

/// Box room `seed` as the trainer sees it.
TrainingScene stored_scene(uint64_t seed) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(seed);
  sample.name = "room";
  data::write_scene_sample(dir / "room.safetensors", sample);
  return read_training_scene(dir / "room.safetensors", "room");
}

/// max |a − b| over max |b|.
double worst(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double difference = 0, most = 0;
  for (size_t i = 0; i < b.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      difference = std::max(difference, std::abs(double{a[i][c]} - b[i][c]));
      most = std::max(most, std::abs(double{b[i][c]}));
    }
  }
  return difference / most;
}

TEST(Augment, SpacePreservesDistancesAnglesAndHeight) {
  Rng rng(1);
  for (int draw = 0; draw < 50; ++draw) {
    const Symmetry symmetry = draw_symmetry({}, 2, room(), kNoLimit, &rng);
    const Vec3 a{rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)};
    const Vec3 b{rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)};
    EXPECT_NEAR(dot(symmetry.space(a), symmetry.space(b)), dot(a, b), 1e-4f);
    EXPECT_NEAR(length(symmetry.space(a) - symmetry.space(b)), length(a - b), 1e-5f);
    EXPECT_EQ(symmetry.space(a).y, a.y);
  }
}

TEST(Augment, MirrorReversesOrientationAndRotationKeepsIt) {
  Rng rng(2);
  int mirrored = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const Symmetry symmetry = draw_symmetry({}, 0, room(), kNoLimit, &rng);
    const float volume =
        dot(cross(symmetry.space({1, 0, 0}), symmetry.space({0, 1, 0})), symmetry.space({0, 0, 1}));
    EXPECT_NEAR(volume, symmetry.mirror ? -1.0f : 1.0f, 1e-5f);
    mirrored += symmetry.mirror ? 1 : 0;
  }
  EXPECT_NEAR(mirrored, 100, 35);  // five standard deviations
}

TEST(Augment, EveryPermutationOfColorsIsDrawn) {
  Rng rng(3);
  std::set<std::array<int, 3>> seen;
  for (int draw = 0; draw < 200; ++draw) {
    const Symmetry symmetry = draw_symmetry({}, 0, room(), kNoLimit, &rng);
    const std::set<int> channels(symmetry.channels.begin(), symmetry.channels.end());
    EXPECT_EQ(channels, (std::set<int>{0, 1, 2}));
    seen.insert(symmetry.channels);
  }
  EXPECT_EQ(seen.size(), 6u);
}

TEST(Augment, GainsAreLogUniformInTheirRange) {
  AugmentConfig config;
  config.gain = 4;
  config.tint = 1;
  Rng rng(4);
  double sum = 0, square = 0;
  constexpr int kDraws = 4000;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Rgb gain = draw_symmetry(config, 1, room(), kNoLimit, &rng).gains[0];
    EXPECT_EQ(gain.x, gain.y) << "brightness is common to the channels";
    EXPECT_GE(gain.x, 0.2499f);
    EXPECT_LE(gain.x, 4.0001f);
    sum += std::log(gain.x);
    square += std::log(gain.x) * std::log(gain.x);
  }
  const double half = std::log(4.0);  // uniform in ±half: mean 0, variance half²/3
  EXPECT_NEAR(sum / kDraws, 0, 5 * half / std::sqrt(3.0 * kDraws));
  EXPECT_NEAR(square / kDraws, half * half / 3, 0.05);
}

TEST(Augment, SwitchedOffIsTheIdentity) {
  const AugmentConfig off{Rotation::None, false, false, 1, 1};
  Rng rng(5);
  const Symmetry symmetry = draw_symmetry(off, 2, room(), kNoLimit, &rng);
  const Vec3 p{1.5f, -2, 3};
  EXPECT_EQ(symmetry.space(p), p);
  EXPECT_EQ(symmetry.light(p, 0), p);
  EXPECT_EQ(symmetry.light(p, 1), p);
  EXPECT_EQ(symmetry.light(p, -1), p);
}

TEST(Augment, EachSwitchActsAlone) {
  const Vec3 p{1, 2, 4};
  Rng rng(6);
  const Symmetry turned =
      draw_symmetry({Rotation::Vertical, false, false, 1, 1}, 1, room(), kNoLimit, &rng);
  EXPECT_NE(turned.space(p), p);
  EXPECT_EQ(turned.light(p, 0), p);
  const Symmetry tinted =
      draw_symmetry({Rotation::None, false, false, 1, 2}, 1, room(), kNoLimit, &rng);
  EXPECT_EQ(tinted.space(p), p);
  EXPECT_NE(tinted.light(p, 0), p);
  EXPECT_EQ(tinted.light(p, -1), p) << "no luminaire, no gain";
}

TEST(Augment, ARoomThatWouldOutgrowTheScaleTurnsByQuarters) {
  Rng rng(7);
  std::set<std::pair<float, float>> angles;
  for (int draw = 0; draw < 100; ++draw) {
    // The room is 4 x 5 m, its diagonal 6.4 m.
    const Symmetry symmetry = draw_symmetry({}, 0, room(), 5, &rng);
    angles.insert({symmetry.rotation[0].x, symmetry.rotation[0].z});
    Bounds turned;
    for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 0, 5}, Vec3{4, 0, 5}}) {
      turned.extend(symmetry.space(corner));
    }
    EXPECT_LE(max_component(turned.extent()), 5.0f);
  }
  EXPECT_EQ(angles, (std::set<std::pair<float, float>>{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}));
}

/// The outside witness: transport computed anew in the transformed scene is the transformed
/// transport.
TEST(Augment, TransportOfTheTransformedSceneIsTheTransformedTransport) {
  const TrainingScene scene = stored_scene(11);
  Rng rng(8);
  for (int draw = 0; draw < 8; ++draw) {
    const Symmetry symmetry = draw_symmetry({}, scene.light_groups, scene.bounds, kNoLimit, &rng);
    const Example example = make_example(scene, symmetry, 0, 0, &rng);
    const float* area = example.points.area.const_data_ptr<float>();
    const test::Transport again = test::transport(
        test::triples_of(example.points.position), test::triples_of(example.points.normal),
        test::triples_of(example.points.albedo), test::triples_of(example.points.emission),
        {area, area + example.points.area.size(0)}, test::triples_of(example.queries.position),
        test::triples_of(example.queries.normal));
    std::vector<Rgb> made = test::triples_of(example.target);
    const at::Tensor radiance = nn::emission_scale(example.points).to(at::kFloat);
    const auto* a = radiance.const_data_ptr<float>();
    for (Rgb& value : made) value *= Rgb{a[0], a[1], a[2]};
    EXPECT_LT(worst(made, again.indirect), 2e-5) << "draw " << draw;
  }
}

TEST(Augment, TargetIsLinearInTheGainOfEachLuminaire) {
  const TrainingScene scene = stored_scene(12);
  Symmetry symmetry = identity_symmetry(2);
  symmetry.gains = {{3, 0, 0.5f}, {0, 2, 0.25f}};
  Rng rng(9);
  const Example example = make_example(scene, symmetry, 0, 0, &rng);
  const std::vector<Rgb> made =
      test::triples_of(example.target * nn::emission_scale(example.points).to(at::kFloat));
  const size_t N = static_cast<size_t>(scene.query_points());
  std::vector<Rgb> expected(N);
  for (size_t i = 0; i < N; ++i) {
    expected[i] = {3 * scene.target[i].x, 2 * scene.target[N + i].y,
                   0.5f * scene.target[i].z + 0.25f * scene.target[N + i].z};
  }
  EXPECT_LT(worst(made, expected), 1e-6);
}

TEST(Augment, DimmingAllLightsAlikeChangesNothingTheNetworkSees) {
  const TrainingScene scene = stored_scene(13);
  Symmetry dimmed = identity_symmetry(2);
  dimmed.gains.assign(2, Rgb{0.125f, 0.125f, 0.125f});  // a power of two: exact in float
  Rng a(1), b(1);
  const Example bright = make_example(scene, identity_symmetry(2), 0, 0, &a);
  const Example dim = make_example(scene, dimmed, 0, 0, &b);
  EXPECT_TRUE(at::equal(bright.target, dim.target));
}

}  // namespace
}  // namespace lte::train
