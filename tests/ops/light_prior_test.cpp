// Means over the neighbours of a light prior against their formulas in double precision.
#include "lte/ops/light_prior.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

using Column = PriorColumn;

constexpr PriorWeights kWeights = {2, 64, 1e-4F, 1e-16F};

struct Prior {
  at::Tensor position, normal, points, normals, light, errors, index;

  Prior(int64_t Q, int64_t S, int64_t K, bool with_errors = true)
      : position(test::normal({Q, 3}, 1, at::kFloat)),
        normal(unit(test::normal({Q, 3}, 2, at::kFloat))),
        points(test::normal({S, 3}, 3, at::kFloat)),
        normals(unit(test::normal({S, 3}, 4, at::kFloat))),
        light(test::normal({S, 12}, 5, at::kFloat).abs()),
        index(test::integers(S, {Q, K}, 6, at::kLong)) {
    normals = at::cat({normals, normals * -0.5}, 1);
    if (with_errors) errors = test::normal({S, 2}, 7, at::kFloat).abs().clamp_max(1);
  }

  static at::Tensor unit(const at::Tensor& v) { return v / v.norm(2, 1, true); }

  at::Tensor means() const {
    return light_prior_means(position, normal, points, normals, light, errors, index, kWeights);
  }

  std::vector<double> exact(int64_t q) const {
    const auto value = [](const at::Tensor& t, int64_t row, int64_t c) {
      return double{t.const_data_ptr<float>()[row * t.size(1) + c]};
    };
    const int64_t K = index.size(1);
    std::vector<double> d2, height, facing, gray, weight, error, out(kPriorMeans + 1, 0);
    std::vector<int64_t> side;
    for (int64_t k = 0; k < K; ++k) {
      const int64_t j = index.const_data_ptr<int64_t>()[q * K + k];
      double square = 0, above = 0, cosine = 0, behind = 0;
      for (int64_t c = 0; c < 3; ++c) {
        const double offset = value(points, j, c) - value(position, q, c);
        square += offset * offset;
        above += offset * value(normal, q, c);
        cosine += value(normals, j, c) * value(normal, q, c);
        behind += value(normals, j, 3 + c) * value(normal, q, c);
      }
      side.push_back(behind > cosine ? 1 : 0);
      cosine = std::max(cosine, behind);
      d2.push_back(square);
      height.push_back(above);
      facing.push_back(std::max(0.0, cosine));
      const int64_t c = 6 * side.back();
      gray.push_back((value(light, j, c) + value(light, j, c + 1) + value(light, j, c + 2)) / 3);
      error.push_back(errors.defined() ? value(errors, j, side.back()) * gray.back() : 0);
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
        out[static_cast<size_t>(c)] += 1e-4 * value(light, j, c + 6 * (1 - side[k]));
      }
      out[Column::kFacing] += facing[k] / static_cast<double>(K);
      out[Column::kHeight] += height[k] / std::sqrt(scale) / static_cast<double>(K);
      out[Column::kGray] += gray[k] / static_cast<double>(K);
    }
    const double total = out[Column::kWeight];
    for (size_t c = 0; c < 6; ++c) out[c] /= total;
    const double mean = (out[0] + out[1] + out[2]) / 3;
    for (size_t k = 0; k < d2.size(); ++k) {
      out[Column::kVariance] += weight[k] * (gray[k] - mean) * (gray[k] - mean) / total;
      out[Column::kNoise] += weight[k] * error[k] * weight[k] * error[k] / (total * total);
    }
    return out;
  }
};

TEST(LightPriorMeans, AreTheirFormulas) {
  for (const bool errors : {false, true}) {
    for (const int64_t K : {1, 5, 16, 31, 32, 33, 64}) {
      const Prior prior(70, 200, K, errors);
      const at::Tensor got = prior.means();
      ASSERT_EQ(got.sizes(), (at::IntArrayRef{70, kPriorMeans + (errors ? 1 : 0)}));
      for (int64_t q = 0; q < 70; ++q) {
        const std::vector<double> expected = prior.exact(q);
        for (int64_t c = 0; c < got.size(1); ++c) {
          const double exact = expected[static_cast<size_t>(c)];
          EXPECT_NEAR(got[q][c].item<double>(), exact, 2e-5 * std::abs(exact) + 1e-6)
              << "errors " << errors << ", K = " << K << ", query " << q << ", column " << c;
        }
      }
    }
  }
}

TEST(LightPriorMeans, CoincidentPointsAreReadAsTheyAre) {
  Prior prior(3, 10, 4);
  prior.points.zero_();
  prior.position.zero_();
  prior.light.fill_(7);
  prior.normals.narrow(1, 3, 3).copy_(prior.normals.narrow(1, 0, 3));  // no query faces a back
  prior.light.narrow(1, 6, 6).zero_();
  const at::Tensor got = prior.means();
  EXPECT_TRUE(got.isfinite().all().item<bool>());
  EXPECT_LT((got.narrow(1, 0, 6) - 7).abs().max().item<float>(), 1e-5);
  EXPECT_EQ(got[0][Column::kDistance2].item<float>(), 1e-16F);
}

TEST(LightPriorMeans, QueriesDoNotSeeEachOtherAndThreadsChangeNothing) {
  const Prior prior(1000, 300, 32);
  const auto run = [&] { return prior.means(); };
  const at::Tensor one = test::with_threads(1, run);
  EXPECT_TRUE(at::equal(one, test::with_threads(3, run)));
  Prior last = prior;
  for (at::Tensor* t : {&last.position, &last.normal, &last.index}) *t = t->narrow(0, 999, 1);
  EXPECT_TRUE(at::equal(last.means(), one.narrow(0, 999, 1)));
  for (at::Tensor* t : {&last.position, &last.normal, &last.index}) *t = t->narrow(0, 0, 0);
  EXPECT_EQ(last.means().sizes(), (at::IntArrayRef{0, kPriorMeans + 1}));
}

/// Over all magnitudes that light, weights and squared distances have.
TEST(LightPriorFeatures, AreTheirFormulasInDouble) {
  const PriorScales scales = {1e-3, 4, 8};
  for (const int64_t columns : {kPriorMeans, kPriorMeans + 1}) {
    const at::Tensor means = test::normal({3000, columns}, 8, at::kFloat).mul(12).exp();
    means.narrow(0, 0, 5).narrow(1, 0, Column::kWeight).zero_();  // darkness
    const at::Tensor got = light_prior_features(means, scales), m = means.to(at::kDouble);
    const at::Tensor g = m.narrow(1, 0, 3).mean(1);
    const auto column = [&](int64_t c) { return m.select(1, c); };
    const auto relative = [&](int64_t c) { return column(c).sqrt().div(g.add(scales.least_mean)); };
    std::vector<at::Tensor> expected;
    for (int64_t c = 0; c < kPriorLight; ++c) expected.push_back(column(c).log1p());
    expected.push_back(relative(Column::kVariance).log1p());
    expected.push_back(column(Column::kWeight).log().div(scales.log));
    expected.push_back(column(Column::kFacing));
    expected.push_back(column(Column::kHeight));
    expected.push_back(column(Column::kGray).log1p() - g.log1p());
    expected.push_back(column(Column::kDistance2).log().add(scales.log_shift).div(scales.log));
    if (columns > kPriorMeans) expected.push_back(relative(Column::kNoise));
    const at::Tensor exact = at::stack(expected, 1);
    const at::Tensor error = (got - exact).abs().div(exact.abs().add(1));
    EXPECT_LT(error.max().item<double>(), 5e-6) << columns << " columns";
    EXPECT_TRUE(
        at::equal(light_prior_features(means.narrow(0, 7, 1), scales), got.narrow(0, 7, 1)));
  }
  EXPECT_TRUE(
      light_prior_features(at::full({1, kPriorMeans}, NAN), scales).isnan().all().item<bool>());
  EXPECT_TRUE(test::throws_saying(
      [&] {
        light_prior_features(at::zeros({2, 5}), scales);
      },
      "means must be"));
}

TEST(LightPriorMeans, RefusesBadInput) {
  const auto refused = [](const auto& edit, const char* words) {
    Prior prior(4, 10, 5);
    edit(prior);
    return test::throws_saying([&] { prior.means(); }, words);
  };
  EXPECT_TRUE(refused([](Prior& c) { c.index[2][3] = 10; }, "query 2, neighbour 3 is 10"));
  EXPECT_TRUE(
      refused([](Prior& c) { c.light = c.light.narrow(1, 0, 3); }, "light must be [10, 12]"));
  EXPECT_TRUE(
      refused([](Prior& c) { c.errors = c.light.narrow(1, 0, 1); }, "errors must be [10, 2]"));
  EXPECT_TRUE(refused([](Prior& c) { c.normal = c.normal.to(at::kDouble); }, "normal must be"));
  EXPECT_TRUE(refused([](Prior& c) { c.normals = c.normals.narrow(0, 0, 9); }, "normals must be"));
  EXPECT_TRUE(refused([](Prior& c) { c.index = c.index.repeat({1, 13}); }, "1 to 64 neighbours"));
}

}  // namespace
}  // namespace lte::ops
