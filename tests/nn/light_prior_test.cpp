#include "lte/nn/points/light_prior.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lte/nn/constants.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

/// A floor at z = 0 lit with 1 + x, and below it, a hundredth of its width away, its dark
/// underside.
LightPrior lit_floor(int64_t count) {
  const at::Tensor xy = at::rand({count, 2});
  const at::Tensor zero = at::zeros({count, 1}), one = at::ones({count, 1});
  const at::Tensor above = at::cat({xy, zero}, 1), below = at::cat({xy, zero - 0.01}, 1);
  const at::Tensor up = at::cat({zero, zero, one}, 1);
  const at::Tensor light = (1 + xy.narrow(1, 0, 1)).expand({-1, 3});
  return make_light_prior(
      at::cat({above, below}), at::cat({up, -up}), at::zeros({2 * count, 3}),
      at::cat({at::cat({light, at::zeros({count, 3})}).repeat({1, 2}), at::zeros({2 * count, 6})},
              1));
}

TEST(LightPrior, ReadsASmoothFieldOnTheSideOfTheQuery) {
  torch::manual_seed(3);
  const LightPrior prior = lit_floor(4000);
  const at::Tensor query = at::cat({at::rand({500, 2}) * 0.8 + 0.1, at::zeros({500, 1})}, 1);
  const at::Tensor up = at::tensor({0.0f, 0.0f, 1.0f}).expand({500, 3});
  const at::Tensor floor = prior.floor[0];
  const at::Tensor lit = prior.read(query, up).irradiance - floor;
  const at::Tensor expected = (1 + query.narrow(1, 0, 1)).expand({-1, 3});
  EXPECT_LT((lit - expected).abs().max().item<double>(), 0.05);
  const at::Tensor below = query - 0.01 * up;
  const at::Tensor dark = prior.read(below, -up).irradiance - floor;
  EXPECT_LT(dark.abs().max().item<double>(), 0.05);
}

TEST(LightPrior, AgreesWithItsFormulaInDoublePrecision) {
  torch::manual_seed(4);
  const int64_t S = 40, Q = 9;
  const auto unit = [](int64_t rows) {
    const at::Tensor v = at::randn({rows, 3});
    return v / v.norm(2, 1, true);
  };
  const at::Tensor p = at::rand({S, 3}), n = unit(S), e = at::rand({S, 12});
  const LightPrior prior = make_light_prior(p, n, at::zeros({S, 3}), e);
  const at::Tensor q = at::rand({Q, 3}), up = unit(Q);
  const LightReading reading = prior.read(q, up);
  const at::Tensor got = reading.irradiance;
  for (int64_t i = 0; i < Q; ++i) {
    std::vector<std::pair<double, int64_t>> near;
    for (int64_t j = 0; j < S; ++j)
      near.emplace_back((p[j] - q[i]).to(at::kDouble).square().sum().item<double>(), j);
    std::sort(near.begin(), near.end());
    near.resize(32);
    double scale = 0, sum = 0, light = 0, direct = 0, heights = 0;
    for (const auto& [d2, j] : near) scale += d2 / 32;
    for (const auto& [d2, j] : near) {
      const double cosine = n[j].dot(up[i]).item<double>();
      const double facing = cosine < 0 ? -kPriorBack * cosine : cosine;
      const double height = (p[j] - q[i]).dot(up[i]).item<double>();
      const double counted =
          std::pow(facing, 4) * std::exp(-(1.5 * d2 + 256 * height * height) / scale);
      const auto lit = [&, side = j, back = cosine < 0](int64_t c) {
        const double front = e[side][c].item<double>(), behind = e[side][6 + c].item<double>();
        return counted * (back ? behind : front) + 1e-3 * (front + behind);
      };
      sum += counted + 1e-3;
      light += lit(1);
      direct += lit(5);
      heights += height / 32;
    }
    const at::Tensor features = reading.features[i];
    EXPECT_NEAR(features[1].item<double>(), std::log1p(light / sum), 1e-5);
    EXPECT_NEAR(features[5].item<double>(), std::log1p(direct / sum), 1e-5);
    EXPECT_NEAR(features[7].item<double>(), std::log(sum) / 4, 1e-4);
    EXPECT_NEAR(features[9].item<double>(), heights / std::sqrt(scale), 1e-5);
    EXPECT_NEAR(features[11].item<double>(), (std::log(scale) + 8) / 4, 1e-5);
    EXPECT_NEAR(got[i][1].item<double>(),
                light / sum + 0.02 * (e.mean(0)[1] + e.mean(0)[7]).item<double>(), 1e-5);
  }
}

/// A curtain of one sheet at z = 0 that has the irradiance 5 on its front and `behind` on its back.
LightReading read_curtain(double behind, double side) {
  torch::manual_seed(8);
  const int64_t S = 3000, Q = 200;
  const at::Tensor p = at::cat({at::rand({S, 2}), at::zeros({S, 1})}, 1),
                   n = at::tensor({0.0f, 0.0f, 1.0f}).expand({S, 3});
  const at::Tensor light =
      at::cat({at::full({S, 6}, 5.0), at::full({S, 6}, behind)}, 1).to(at::kFloat);
  const LightPrior prior = make_light_prior(p, n, at::zeros({S, 3}), light, at::full({S, 2}, 0.5f));
  const at::Tensor query = at::cat({at::rand({Q, 2}), at::zeros({Q, 1})}, 1);
  LightReading reading = prior.read(query, n.narrow(0, 0, Q) * side);
  reading.irradiance = reading.irradiance - prior.floor;
  return reading;
}

/// A query reads the other side by the least weight beside that of a front, or of a back.
TEST(LightPrior, EachSideOfACurtainHasItsOwnLight) {
  for (const double behind : {0.0, 0.25, 40.0}) {
    for (const double side : {1.0, -1.0}) {
      const double own = side > 0 ? 5 : behind, other = side > 0 ? behind : 5;
      const LightReading reading = read_curtain(behind, side);
      const double share = side > 0 ? 0.01 : 0.06;
      EXPECT_LE((reading.irradiance - own).abs().max().item<double>(), share * other + 1e-4)
          << behind << ", side " << side;
      EXPECT_LE((reading.features.narrow(1, 3, 3).expm1() - own).abs().max().item<double>(),
                share * other + 1e-4);
    }
  }
}

/// The mean of n estimates of relative error r that count alike has the error r / sqrt(n). Here
/// some count for less, so that it is more, but less than that of one.
TEST(LightPrior, KnowsTheErrorOfItsMean) {
  const at::Tensor error = read_curtain(0, 1).features.select(1, kLightFeatures);
  EXPECT_GT(error.min().item<double>(), 0.5 / std::sqrt(32.0));
  EXPECT_LT(error.max().item<double>(), 0.5 / std::sqrt(8.0));
}

TEST(LightPrior, EstimatesWithErrorsAgreeInSingleAndDoublePrecision) {
  torch::manual_seed(7);
  for (const int64_t S : {1, 20, 700}) {
    at::Tensor n = at::randn({S, 3}), up = at::randn({50, 3});
    n.div_(n.norm(2, 1, true)), up.div_(up.norm(2, 1, true));
    const at::Tensor p = at::rand({S, 3}), e = at::rand({S, 12}), dark = at::zeros({S, 3}),
                     r = at::rand({S, 2}), q = at::rand({50, 3});
    const auto exact = [](const at::Tensor& t) { return t.to(at::kDouble); };
    const LightReading got = make_light_prior(p, n, dark, e, r).read(q, up);
    const LightReading expected =
        make_light_prior(exact(p), exact(n), exact(dark), exact(e), exact(r))
            .read(exact(q), exact(up));
    EXPECT_EQ(got.features.size(1), kLightFeatures + 1);
    EXPECT_LT((got.irradiance - expected.irradiance).abs().max().item<double>(), 1e-5) << S;
    EXPECT_LT((got.features - expected.features).abs().max().item<double>(), 1e-3) << S;
  }
}

TEST(LightPrior, SinglePrecisionReadsWhatDoublePrecisionDoes) {
  torch::manual_seed(6);
  for (const int64_t S : {1, 20, 700}) {  // fewer points than neighbours, and more
    at::Tensor n = at::randn({S, 3}), up = at::randn({50, 3});
    n.div_(n.norm(2, 1, true)), up.div_(up.norm(2, 1, true));
    const at::Tensor p = at::rand({S, 3}), e = at::rand({S, 12}), dark = at::zeros({S, 3}),
                     q = at::rand({50, 3});
    const auto exact = [](const at::Tensor& t) { return t.to(at::kDouble); };
    const LightReading got = make_light_prior(p, n, dark, e).read(q, up);
    const LightReading expected =
        make_light_prior(exact(p), exact(n), exact(dark), exact(e)).read(exact(q), exact(up));
    EXPECT_LT((got.irradiance - expected.irradiance).abs().max().item<double>(), 1e-5) << S;
    // The spread is a root: of one point, that of a rounding.
    EXPECT_LT((got.features - expected.features).abs().max().item<double>(), 1e-3) << S;
  }
}

TEST(LightPrior, AnswersDoNotDependOnBlocksAndLuminairesDoNotCount) {
  torch::manual_seed(5);
  const at::Tensor p = at::rand({300, 3}), n = at::zeros({300, 3});
  n.select(1, 2).fill_(1);
  at::Tensor emission = at::zeros({300, 3}), light = at::rand({300, 12});
  emission.narrow(0, 0, 20).fill_(1);
  const LightPrior prior = make_light_prior(p, n, emission, light);
  EXPECT_EQ(prior.position.size(0), 280);
  const at::Tensor q = at::rand({9000, 3}), up = n.narrow(0, 0, 1).expand({9000, 3});
  const LightReading all = prior.read(q, up);
  for (const int64_t begin : {0, 4000, 8999}) {
    const LightReading one = prior.read(q.narrow(0, begin, 1), up.narrow(0, begin, 1));
    const auto difference = [&](const at::Tensor& a, const at::Tensor& b) {
      return (a - b.narrow(0, begin, 1)).abs().max().item<double>();
    };
    EXPECT_LT(difference(one.irradiance, all.irradiance), 1e-6);
    EXPECT_LT(difference(one.features, all.features), 1e-5);
  }
  light.narrow(0, 0, 20).fill_(1e6);
  const auto read = [&] { return make_light_prior(p, n, emission, light).read(q, up); };
  EXPECT_TRUE(at::equal(read().irradiance, all.irradiance));
  EXPECT_TRUE(at::equal(read().features, all.features));
  emission.fill_(1);
  EXPECT_TRUE(at::equal(read().irradiance, at::ones({9000, 3})));
  EXPECT_TRUE(at::equal(read().features, at::zeros({9000, kLightFeatures})));
}

}  // namespace
}  // namespace lte::nn
