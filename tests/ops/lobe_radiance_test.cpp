// The late radiance head in one operator against its formulas in double precision.
#include "lte/ops/lobe_radiance.h"

#include <cmath>
#include <limits>
#include <vector>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

struct Lobes {
  at::Tensor own, directions, light, seen;
  LobeWeights weights;
  int64_t Q, N, K;

  Lobes(int64_t points, int64_t count, int64_t lobes, bool with_light, bool with_seen)
      : own(test::normal({points, 5 * lobes}, 1, at::kFloat)),
        directions(test::normal({points, count, 3}, 2, at::kFloat)),
        Q(points),
        N(count),
        K(lobes) {
    const int64_t inputs = K + (with_seen ? kSeenFeatures : 0), factors = with_seen ? 6 : 3;
    if (with_light) light = test::normal({Q, 3}, 3, at::kFloat).abs();
    if (with_seen) seen = test::normal({Q, N, kSeenColumns}, 4, at::kFloat);
    const double scale = 1 / std::sqrt(static_cast<double>(inputs));
    weights.mix = {test::normal({K, inputs}, 5, at::kFloat) * scale,
                   test::normal({K}, 6, at::kFloat)};
    weights.color = {test::normal({factors, K}, 7, at::kFloat),
                     test::normal({factors}, 8, at::kFloat)};
  }

  template <typename Put>
  at::Tensor answer(const Put& put) const {
    return lobe_radiance_inference(put(own), put(directions), put(light), put(seen),
                                   {{put(weights.mix.weight), put(weights.mix.bias)},
                                    {put(weights.color.weight), put(weights.color.bias)}})
        .cpu();
  }
  at::Tensor answer() const {
    return answer([](const at::Tensor& t) { return t; });
  }

  at::Tensor exact() const {
    const auto values = [](const at::Tensor& t) {
      const at::Tensor flat = t.to(at::kDouble).contiguous().view({-1});
      return std::vector<double>(flat.const_data_ptr<double>(),
                                 flat.const_data_ptr<double>() + flat.numel());
    };
    const auto k_size = static_cast<size_t>(K);
    const std::vector<double> o = values(own), d = values(directions),
                              mix = values(weights.mix.weight), mix_bias = values(weights.mix.bias),
                              color = values(weights.color.weight),
                              color_bias = values(weights.color.bias);
    const std::vector<double> l = light.defined() ? values(light) : std::vector<double>(),
                              s = seen.defined() ? values(seen) : std::vector<double>();
    const auto gelu = [](double x) { return x * 0.5 * std::erfc(-x / std::sqrt(2.0)); };
    at::Tensor out = at::empty({Q, N, 3}, at::kDouble);
    auto* to = out.data_ptr<double>();
    for (size_t row = 0; row < static_cast<size_t>(Q * N); ++row) {
      const size_t q = row / static_cast<size_t>(N), begin = q * 5 * k_size;
      std::vector<double> input, mixed;
      for (size_t k = 0; k < k_size; ++k) {
        double sum = o[begin + 3 * k_size + k];
        for (size_t axis = 0; axis < 3; ++axis) sum += o[begin + 3 * k + axis] * d[3 * row + axis];
        input.push_back(gelu(sum));
      }
      for (size_t c = 3; seen.defined() && c < 10; ++c) input.push_back(s[10 * row + c]);
      for (size_t k = 0; k < k_size; ++k) {
        double sum = mix_bias[k] + o[begin + 4 * k_size + k];
        for (size_t i = 0; i < input.size(); ++i) sum += mix[k * input.size() + i] * input[i];
        mixed.push_back(gelu(sum));
      }
      const auto factor = [&](size_t f) {
        double sum = color_bias[f];
        for (size_t k = 0; k < k_size; ++k) sum += color[f * k_size + k] * mixed[k];
        return std::max(sum, 0.0) + std::log1p(std::exp(-std::abs(sum)));
      };
      for (size_t c = 0; c < 3; ++c) {
        to[3 * row + c] = factor(c) * (light.defined() ? l[3 * q + c] : 1);
        if (seen.defined()) to[3 * row + c] += factor(3 + c) * s[10 * row + c];
      }
    }
    return out;
  }
};

class LobeRadiance : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(LobeRadiance);

TEST_P(LobeRadiance, IsTheFormulaForEveryShape) {
  const auto on_device = [this](const at::Tensor& t) { return put(t); };
  // Points that end within a tile of 96, at its border and beyond; lobes of less than a block, of
  // whole ones, and of more than a panel of 128.
  for (const auto& [Q, N] : {std::pair{1, 1}, {7, 1}, {3, 32}, {2, 97}, {5, 300}}) {
    for (const int64_t K : {1, 6, 16, 48, 130}) {
      for (const bool light : {false, true}) {
        for (const bool seen : {false, true}) {
          const Lobes lobes(Q, N, K, light, seen);
          EXPECT_LT(test::relative_error(lobes.answer(on_device), lobes.exact()), tolerance(3e-6))
              << Q << " points, " << N << " directions, " << K << " lobes, light " << light
              << ", seen " << seen;
        }
      }
    }
  }
  for (const auto& [Q, N] : {std::pair{0, 4}, {4, 0}})
    EXPECT_EQ(Lobes(Q, N, 6, true, true).answer(on_device).sizes(), (at::IntArrayRef{Q, N, 3}));
}

TEST_P(LobeRadiance, RoundsWhatTheMixtureReadsWhereItsWeightsAre) {
  Lobes lobes(4, 50, 48, true, true);
  const at::Tensor full = lobes.exact();
  lobes.weights.mix.weight = lobes.weights.mix.weight.to(at::kBFloat16);
  const at::Tensor got = lobes.answer([this](const at::Tensor& t) { return put(t); });
  EXPECT_LT(test::relative_error(got, lobes.exact()), 1e-2);
  EXPECT_GT(test::relative_error(got, full), 1e-5);
}

TEST(LobeRadianceOnTheCpu, OneRowIsTheSameBitsInAnyCompany) {
  const Lobes lobes(6, 40, 48, true, true);
  const at::Tensor all = lobes.answer();
  EXPECT_TRUE(at::equal(all, test::with_threads(3, [&] { return lobes.answer(); })));
  Lobes one = lobes;
  one.Q = one.N = 1;
  one.own = lobes.own.narrow(0, 4, 1);
  one.light = lobes.light.narrow(0, 4, 1);
  one.directions = lobes.directions.narrow(0, 4, 1).narrow(1, 33, 1);
  one.seen = lobes.seen.narrow(0, 4, 1).narrow(1, 33, 1);
  EXPECT_TRUE(at::equal(one.answer().view({3}), all[4][33]));
}

TEST(LobeRadianceOnTheCpu, SoftplusHoldsFarFromZeroAndKeepsWhatIsNotANumber) {
  // One lobe that is always 0, so that the bias of each channel comes through.
  Lobes lobes(1, 1, 1, false, false);
  lobes.weights.color.weight.zero_();
  for (const float x : {-80.0F, -20.0F, -1.0F, 0.0F, 1e-4F, 3.0F, 15.0F, 88.0F, 1e20F}) {
    lobes.weights.color.bias.fill_(x);
    const double expected = std::max(double{x}, 0.0) + std::log1p(std::exp(-std::abs(double{x})));
    EXPECT_NEAR(lobes.answer()[0][0][0].item<double>() / expected, 1, 1e-6) << x;
  }
  lobes.weights.color.bias.fill_(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(lobes.answer()[0][0][0].item<float>()));
}

TEST(LobeRadianceOnTheCpu, RefusesWhatDoesNotFit) {
  const auto refused = [](const auto& spoil, const char* words) {
    Lobes lobes(2, 3, 6, true, true);
    spoil(lobes);
    EXPECT_TRUE(test::throws_saying([&] { lobes.answer(); }, words)) << words;
  };
  refused([](Lobes& l) { l.own = l.own.narrow(1, 0, 29); }, "own must be [2, 30]");
  refused([](Lobes& l) { l.directions = l.directions.narrow(2, 0, 2); }, "directions must be");
  refused([](Lobes& l) { l.light = l.light.to(at::kDouble); }, "light must be [2, 3]");
  refused([](Lobes& l) { l.seen = l.seen.narrow(2, 0, 9); }, "seen must be [2, 3, 10]");
  refused([](Lobes& l) { l.seen = at::Tensor(); }, "mix must be [6, 6]");
  refused([](Lobes& l) { l.weights.color.weight = l.weights.color.weight.narrow(0, 0, 3); },
          "color must be [6, 6]");
  refused([](Lobes& l) { l.weights.mix.bias = l.weights.mix.bias.narrow(0, 0, 5); },
          "mix's bias must be [6]");
}

}  // namespace
}  // namespace lte::ops
