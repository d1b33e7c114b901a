// Means over the neighbours in a cache of irradiance against their formulas in double precision.
#include "lte/ops/irradiance_cache.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

using Column = CacheColumn;

constexpr CacheWeights kWeights = {2, 64, 1e-4F, 1e-16F};

struct Cache {
  at::Tensor position, normal, points, normals, light, errors, index;
  int64_t sides;

  /// @param of_sides  how many each point has; those of two sides have errors
  Cache(int64_t Q, int64_t S, int64_t K, int64_t of_sides = 1)
      : position(test::normal({Q, 3}, 1, at::kFloat)),
        normal(unit(test::normal({Q, 3}, 2, at::kFloat))),
        points(test::normal({S, 3}, 3, at::kFloat)),
        normals(unit(test::normal({S, 3}, 4, at::kFloat))),
        light(test::normal({S, 6 * of_sides}, 5, at::kFloat).abs()),
        index(test::integers(S, {Q, K}, 6, at::kLong)),
        sides(of_sides) {
    if (sides == 1) return;
    normals = at::cat({normals, normals * -0.5}, 1);
    errors = test::normal({S, 2}, 7, at::kFloat).abs().clamp_max(1);
  }

  static at::Tensor unit(const at::Tensor& v) { return v / v.norm(2, 1, true); }

  at::Tensor means() const {
    return irradiance_cache_means(position, normal, points, normals, light, errors, index,
                                  kWeights);
  }

  std::vector<double> exact(int64_t q) const {
    const auto value = [](const at::Tensor& t, int64_t row, int64_t c) {
      return double{t.const_data_ptr<float>()[row * t.size(1) + c]};
    };
    const int64_t K = index.size(1);
    std::vector<double> d2, height, facing, grey, weight, error, out(kCacheMeans + 1, 0);
    std::vector<int64_t> side;
    for (int64_t k = 0; k < K; ++k) {
      const int64_t j = index.const_data_ptr<int64_t>()[q * K + k];
      double square = 0, above = 0, cosine = 0, behind = 0;
      for (int64_t c = 0; c < 3; ++c) {
        const double offset = value(points, j, c) - value(position, q, c);
        square += offset * offset;
        above += offset * value(normal, q, c);
        cosine += value(normals, j, c) * value(normal, q, c);
        if (sides == 2) behind += value(normals, j, 3 + c) * value(normal, q, c);
      }
      side.push_back(sides == 2 && behind > cosine ? 1 : 0);
      cosine = std::max(cosine, sides == 2 ? behind : cosine);
      d2.push_back(square);
      height.push_back(above);
      facing.push_back(std::max(0.0, cosine));
      const int64_t c = 6 * side.back();
      grey.push_back((value(light, j, c) + value(light, j, c + 1) + value(light, j, c + 2)) / 3);
      error.push_back(sides == 2 ? value(errors, j, side.back()) * grey.back() : 0);
      out[Column::kDistance2] += square / static_cast<double>(K);
    }
    const double scale = std::max(out[Column::kDistance2], 1e-16);
    out[Column::kDistance2] = scale;
    for (size_t k = 0; k < d2.size(); ++k) {
      const int64_t j = index.const_data_ptr<int64_t>()[q * K + static_cast<int64_t>(k)];
      const double w =
          std::pow(facing[k], 4) * std::exp(-(2 * d2[k] + 64 * height[k] * height[k]) / scale) +
          1e-4;
      weight.push_back(w);
      out[Column::kWeight] += w;
      for (int64_t c = 0; c < 6; ++c) {
        out[static_cast<size_t>(c)] += w * value(light, j, c + 6 * side[k]);
        // The least weight is for the light of both sides.
        if (sides == 2)
          out[static_cast<size_t>(c)] += 1e-4 * value(light, j, c + 6 * (1 - side[k]));
      }
      out[Column::kFacing] += facing[k] / static_cast<double>(K);
      out[Column::kHeight] += height[k] / std::sqrt(scale) / static_cast<double>(K);
      out[Column::kGrey] += grey[k] / static_cast<double>(K);
    }
    const double total = out[Column::kWeight];
    for (size_t c = 0; c < 6; ++c) out[c] /= total;
    const double mean = (out[0] + out[1] + out[2]) / 3;
    for (size_t k = 0; k < d2.size(); ++k) {
      out[Column::kVariance] += weight[k] * (grey[k] - mean) * (grey[k] - mean) / total;
      out[Column::kNoise] += weight[k] * error[k] * weight[k] * error[k] / (total * total);
    }
    return out;
  }
};

TEST(IrradianceCacheMeans, AreTheirFormulas) {
  for (const int64_t sides : {1, 2}) {
    for (const int64_t K : {1, 5, 16, 31, 32, 33, 64}) {
      const Cache cache(70, 200, K, sides);
      const at::Tensor got = cache.means();
      ASSERT_EQ(got.sizes(), (at::IntArrayRef{70, kCacheMeans + sides - 1}));
      for (int64_t q = 0; q < 70; ++q) {
        const std::vector<double> expected = cache.exact(q);
        for (int64_t c = 0; c < got.size(1); ++c) {
          const double exact = expected[static_cast<size_t>(c)];
          EXPECT_NEAR(got[q][c].item<double>(), exact, 2e-5 * std::abs(exact) + 1e-6)
              << "sides = " << sides << ", K = " << K << ", query " << q << ", column " << c;
        }
      }
    }
  }
}

/// Two sides of which nobody faces the back, and whose backs are dark, are one side.
TEST(IrradianceCacheMeans, DarkBacksThatNobodyFacesChangeNothing) {
  Cache one(20, 100, 32);
  one.normal = one.normal.select(0, 0).expand({20, 3}).contiguous();
  const at::Tensor facing = at::matmul(one.normals, one.normal[0]).ge(0).unsqueeze(1);
  one.normals = at::where(facing, one.normals, -one.normals);
  Cache two = one;
  two.normals = at::cat({one.normals, -one.normals}, 1);
  two.light = at::cat({one.light, at::zeros_like(one.light)}, 1);
  EXPECT_TRUE(at::equal(one.means(), two.means()));
}

TEST(IrradianceCacheMeans, CoincidentPointsAreReadAsTheyAre) {
  Cache cache(3, 10, 4);
  cache.points.zero_();
  cache.position.zero_();
  cache.light.fill_(7);
  const at::Tensor got = cache.means();
  EXPECT_TRUE(got.isfinite().all().item<bool>());
  EXPECT_LT((got.narrow(1, 0, 6) - 7).abs().max().item<float>(), 1e-5);
  EXPECT_EQ(got[0][Column::kDistance2].item<float>(), 1e-16F);
}

TEST(IrradianceCacheMeans, QueriesDoNotSeeEachOtherAndThreadsChangeNothing) {
  const Cache cache(1000, 300, 32);
  const auto run = [&] { return cache.means(); };
  const at::Tensor one = test::with_threads(1, run);
  EXPECT_TRUE(at::equal(one, test::with_threads(3, run)));
  Cache last = cache;
  for (at::Tensor* t : {&last.position, &last.normal, &last.index}) *t = t->narrow(0, 999, 1);
  EXPECT_TRUE(at::equal(last.means(), one.narrow(0, 999, 1)));
  for (at::Tensor* t : {&last.position, &last.normal, &last.index}) *t = t->narrow(0, 0, 0);
  EXPECT_EQ(last.means().sizes(), (at::IntArrayRef{0, kCacheMeans}));
}

TEST(IrradianceCacheMeans, RefusesBadInput) {
  const auto refused = [](const auto& edit, const char* words) {
    Cache cache(4, 10, 5);
    edit(cache);
    return test::throws_saying([&] { cache.means(); }, words);
  };
  EXPECT_TRUE(refused([](Cache& c) { c.index[2][3] = 10; }, "query 2, neighbour 3 is 10"));
  EXPECT_TRUE(
      refused([](Cache& c) { c.light = c.light.narrow(1, 0, 3); }, "light must be [10, 6]"));
  EXPECT_TRUE(refused(
      [](Cache& c) {
        c.normals = c.normals.repeat({1, 2});
      },
      "light must be [10, 12]"));
  EXPECT_TRUE(
      refused([](Cache& c) { c.errors = c.light.narrow(1, 0, 2); }, "errors must be [10, 1]"));
  EXPECT_TRUE(refused([](Cache& c) { c.normal = c.normal.to(at::kDouble); }, "normal must be"));
  EXPECT_TRUE(refused([](Cache& c) { c.normals = c.normals.narrow(0, 0, 9); }, "normals must be"));
  EXPECT_TRUE(refused([](Cache& c) { c.index = c.index.repeat({1, 13}); }, "1 to 64 neighbours"));
}

}  // namespace
}  // namespace lte::ops
