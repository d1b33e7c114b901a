#include "lte/base/math.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte {
namespace {

Vec3 random_direction(Rng* rng) {
  for (;;) {
    const Vec3 v{rng->uniform(-1, 1), rng->uniform(-1, 1), rng->uniform(-1, 1)};
    if (length(v) > 0.1f && length(v) <= 1) return normalize(v);
  }
}

TEST(Frame, IsRightHandedAndOrthonormalForEveryNormal) {
  Rng rng(1);
  std::vector<Vec3> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0, 0, -0.0f}};
  normals.pop_back();
  for (int i = 0; i < 1000; ++i) normals.push_back(random_direction(&rng));
  for (const Vec3& n : normals) {
    Vec3 t, b;
    make_frame(n, &t, &b);
    EXPECT_NEAR(length(t), 1, 2e-6);
    EXPECT_NEAR(length(b), 1, 2e-6);
    EXPECT_NEAR(dot(t, n), 0, 2e-6);
    EXPECT_NEAR(dot(b, n), 0, 2e-6);
    EXPECT_NEAR(length(cross(t, b) - n), 0, 5e-6);
  }
}

TEST(Affine, ProductAppliesTheRightFactorFirst) {
  Rng rng(2);
  Affine a, b;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 4; ++col) {
      a.m[row][col] = rng.uniform(-2, 2);
      b.m[row][col] = rng.uniform(-2, 2);
    }
  }
  const Vec3 p{0.3f, -1.2f, 2.5f};
  EXPECT_NEAR(length((a * b).point(p) - a.point(b.point(p))), 0, 1e-5);
  EXPECT_NEAR(length((a * b).vector(p) - a.vector(b.vector(p))), 0, 1e-5);
  EXPECT_NEAR((a * b).determinant(), a.determinant() * b.determinant(), 1e-4);
}

TEST(Affine, MirrorHasNegativeDeterminant) {
  Affine mirror;
  EXPECT_EQ(mirror.determinant(), 1);
  mirror.m[1][1] = -1;
  EXPECT_EQ(mirror.determinant(), -1);
}

TEST(Bounds, GrowFromEmpty) {
  Bounds bounds;
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds.extent(), (Vec3{0, 0, 0}));
  bounds.extend({1, 2, 3});
  EXPECT_FALSE(bounds.empty());
  bounds.extend({-1, 4, 3});
  EXPECT_EQ(bounds.extent(), (Vec3{2, 2, 0}));
  EXPECT_EQ(bounds.center(), (Vec3{0, 3, 3}));
}

TEST(Normalize, LeavesZeroAlone) { EXPECT_EQ(normalize(Vec3{}), Vec3{}); }

TEST(Rng, RepeatsForTheSameSeedAndStream) {
  Rng a(5, 7), b(5, 7);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.next_u64(), b.next_u64());
}

TEST(Rng, StreamsAndSeedsDiffer) {
  std::set<uint64_t> seen;
  for (uint64_t seed = 0; seed < 32; ++seed) {
    for (uint64_t stream = 0; stream < 32; ++stream) seen.insert(Rng(seed, stream).next_u64());
  }
  EXPECT_EQ(seen.size(), 1024u);
}

TEST(Rng, UniformHasTheMomentsOfTheUniformDistribution) {
  Rng rng(3);
  double sum = 0, squares = 0;
  constexpr int kCount = 1'000'000;
  for (int i = 0; i < kCount; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount));
}

TEST(Rng, BelowIsUniform) {
  Rng rng(4);
  std::vector<int> counts(10);
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) ++counts[rng.below(10)];
  double chi2 = 0;
  for (const int count : counts) chi2 += (count - 1e4) * (count - 1e4) / 1e4;
  EXPECT_LT(chi2, 27.9);  // 0.999 quantile at 9 degrees of freedom
}

TEST(MixBits, IsSplitMix64) {
  // First output of SplitMix64 from state 0, as published with the generator.
  EXPECT_EQ(mix_bits(0x9e3779b97f4a7c15ULL), 0xe220a8397b1dcdafULL);
}

}  // namespace
}  // namespace lte
