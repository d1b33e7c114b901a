#include "train/data/augment.h"

#include <array>
#include <cmath>
#include <set>
#include <string>

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
TrainingScene stored_scene(uint64_t seed, nn::Target target) {
  const test::TempDir dir;
  data::SceneSample sample = test::box_sample(seed);
  sample.name = "room";
  data::write_scene_sample(dir / "room.safetensors", sample);
  return read_training_scene(dir / "room.safetensors", "room", target);
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

TEST(Augment, OneLightAloneIsLitAsOftenAsAskedAndEachAsOften) {
  AugmentConfig config;
  config.single_light = 0.75;
  Rng rng(31, 0);
  constexpr int kDraws = 4000, kGroups = 3;
  std::array<int, kGroups> lit{};
  int single = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Symmetry symmetry = draw_symmetry(config, kGroups, room(), kNoLimit, &rng);
    int on = 0, last = 0;
    for (int g = 0; g < kGroups; ++g) {
      const Rgb& gain = symmetry.gains[static_cast<size_t>(g)];
      if (gain[0] == 0 && gain[1] == 0 && gain[2] == 0) continue;
      on += 1;
      last = g;
    }
    ASSERT_TRUE(on == 1 || on == kGroups);
    if (on > 1) continue;
    single += 1;
    lit[static_cast<size_t>(last)] += 1;
  }
  EXPECT_NEAR(single, 0.75 * kDraws, 110);  // four standard deviations
  for (const int times : lit) EXPECT_NEAR(times, single / 3.0, 105);
  EXPECT_NE(draw_symmetry(config, 1, room(), kNoLimit, &rng).gains[0][0], 0);
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

TEST(Augment, AnyAxisTurnsKeepDistancesAnglesAndOrientation) {
  const AugmentConfig any{Rotation::Any, false, false, 1, 1};
  Rng rng(10);
  for (int draw = 0; draw < 200; ++draw) {
    const Symmetry symmetry = draw_symmetry(any, 0, room(), kNoLimit, &rng);
    const Vec3 a{rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)};
    const Vec3 b{rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)};
    EXPECT_NEAR(dot(symmetry.space(a), symmetry.space(b)), dot(a, b), 2e-4f);
    const float volume =
        dot(cross(symmetry.space({1, 0, 0}), symmetry.space({0, 1, 0})), symmetry.space({0, 0, 1}));
    EXPECT_NEAR(volume, 1.0f, 1e-5f);
  }
}

/// Of a uniform rotation each entry has mean 0 and mean square 1/3, whatever its place.
TEST(Augment, AnyAxisTurnsAreUniform) {
  const AugmentConfig any{Rotation::Any, false, false, 1, 1};
  Rng rng(11);
  constexpr int kDraws = 6000;
  double sum[3][3] = {}, square[3][3] = {};
  for (int draw = 0; draw < kDraws; ++draw) {
    const Symmetry symmetry = draw_symmetry(any, 0, room(), kNoLimit, &rng);
    for (size_t row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        const double entry = symmetry.rotation[row][column];
        sum[row][column] += entry;
        square[row][column] += entry * entry;
      }
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      EXPECT_NEAR(sum[row][column] / kDraws, 0, 5 * std::sqrt(1.0 / 3 / kDraws));
      // Uniform in [-1, 1] each (Archimedes): the square's variance is 1/5 - 1/9.
      EXPECT_NEAR(square[row][column] / kDraws, 1.0 / 3,
                  5 * std::sqrt((1.0 / 5 - 1.0 / 9) / kDraws));
    }
  }
}

TEST(Augment, AboutAnyAxisARoomThatWouldOutgrowTheScaleTurnsAsTheCubeDoes) {
  const AugmentConfig any{Rotation::Any, false, false, 1, 1};
  Rng rng(12);
  std::set<std::string> seen;
  for (int draw = 0; draw < 1500; ++draw) {
    const Symmetry symmetry = draw_symmetry(any, 0, room(), 5, &rng);  // 4 x 3 x 5 m
    Bounds turned;
    for (int corner = 0; corner < 8; ++corner) {
      turned.extend(symmetry.space(
          {corner & 1 ? 4.0f : 0.0f, corner & 2 ? 3.0f : 0.0f, corner & 4 ? 5.0f : 0.0f}));
    }
    ASSERT_LE(max_component(turned.extent()), 5.0f);
    std::string key;
    bool whole = true;
    for (const Vec3& row : symmetry.rotation) {
      for (int c = 0; c < 3; ++c) {
        whole = whole && (row[c] == 0 || std::abs(row[c]) == 1);
        key += row[c] > 0.5f ? '+' : row[c] < -0.5f ? '-' : '0';
      }
    }
    if (whole) seen.insert(key);
  }
  EXPECT_EQ(seen.size(), 24u);
}

/// The outside witness: transport computed anew in the transformed scene is the transformed
/// transport.
TEST(Augment, TransportOfTheTransformedSceneIsTheTransformedTransport) {
  for (const nn::Target target : {nn::Target::Indirect, nn::Target::Total}) {
    const TrainingScene scene = stored_scene(11, target);
    Rng rng(8);
    for (int draw = 0; draw < 8; ++draw) {
      AugmentConfig config;
      if (draw % 2 == 1) config.rotate = Rotation::Any;
      const Symmetry symmetry =
          draw_symmetry(config, scene.light_groups, scene.bounds, kNoLimit, &rng);
      const Example example = make_example(scene, symmetry, 0, 0, &rng);
      const float* area = example.points.area.const_data_ptr<float>();
      const test::Transport again = test::transport(
          test::triples_of(example.points.position), test::triples_of(example.points.normal),
          test::triples_of(example.points.albedo), test::triples_of(example.points.emission),
          {area, area + example.points.area.size(0)}, test::triples_of(example.queries.position),
          test::triples_of(example.queries.normal));
      std::vector<Rgb> expected = again.indirect;
      if (target == nn::Target::Total) {
        for (size_t i = 0; i < expected.size(); ++i) expected[i] += again.direct[i];
      }
      std::vector<Rgb> made = test::triples_of(example.target);
      const at::Tensor radiance = nn::emission_scale(example.points).to(at::kFloat);
      const auto* a = radiance.const_data_ptr<float>();
      for (Rgb& value : made) value *= Rgb{a[0], a[1], a[2]};
      EXPECT_LT(worst(made, expected), 2e-5) << enum_name(target) << ", draw " << draw;
    }
  }
}

TEST(Augment, TargetIsLinearInTheGainOfEachLuminaire) {
  const TrainingScene scene = stored_scene(12, nn::Target::Indirect);
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
  const TrainingScene scene = stored_scene(13, nn::Target::Indirect);
  Symmetry dimmed = identity_symmetry(2);
  dimmed.gains.assign(2, Rgb{0.125f, 0.125f, 0.125f});  // a power of two: exact in float
  Rng a(1), b(1);
  const Example bright = make_example(scene, identity_symmetry(2), 0, 0, &a);
  const Example dim = make_example(scene, dimmed, 0, 0, &b);
  EXPECT_TRUE(at::equal(bright.target, dim.target));
}

}  // namespace
}  // namespace lte::train
