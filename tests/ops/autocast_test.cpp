#include <torch/csrc/autograd/autograd.h>
// Operators of mixed-precision training against the same formulas in float64 with operands rounded
// to bfloat16 wherever a product reads them, and against finite differences of the exact ones.
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <torch/autograd.h>

#include "lte/ops/linear.h"
#include "lte/ops/submanifold_conv.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

at::Tensor leaf(const at::Tensor& t) { return t.clone().requires_grad_(); }

/// To the nearest bfloat16, ties to even, by LibTorch.
double error(const at::Tensor& got, const at::Tensor& expected) {
  EXPECT_EQ(got.scalar_type(), at::kFloat);
  EXPECT_EQ(got.sizes(), expected.sizes());
  return ((got.to(at::kDouble) - expected).norm() / expected.norm()).item<double>();
}

// Leaves stay on the CPU and are put on the device, so gradients come back to the CPU.

class LinearAutocast : public test::PerDevice {
 protected:
  at::Tensor layer(const at::Tensor& x, const at::Tensor& weight,
                   const at::Tensor& bias = {}) const {
    return linear_autocast(put(x), put(weight), put(bias)).cpu();
  }
};
LTE_FOR_EACH_DEVICE(LinearAutocast);

class SubmanifoldConvAutocast : public test::PerDevice {
 protected:
  at::Tensor convolve(const at::Tensor& input, const at::Tensor& weight, const at::Tensor& bias,
                      const at::Tensor& pairs, const at::Tensor& tap_begin) const {
    return submanifold_conv_autocast(put(input), put(weight), put(bias), put(pairs), tap_begin)
        .cpu();
  }
};
LTE_FOR_EACH_DEVICE(SubmanifoldConvAutocast);

// Sizes about a pair, a block and a panel of channels, and about the rows that are multiplied, or
// summed, at once.
const std::vector<std::array<int64_t, 3>> kShapes = {
    {1, 1, 1},      {2, 2, 17},  {3, 16, 15},   {95, 128, 128}, {127, 129, 130},
    {128, 257, 31}, {129, 3, 5}, {8191, 16, 8}, {8193, 8, 33},  {20001, 5, 16}};

TEST_P(LinearAutocast, RoundsWhatItsThreeProductsReadAndNothingElse) {
  for (const auto& [rows, inputs, outputs] : kShapes) {
    const at::Tensor x = leaf(test::floats({rows, inputs}, 1)),
                     weight = leaf(test::floats({outputs, inputs}, 2)),
                     bias = leaf(test::floats({outputs}, 3)),
                     grad = test::floats({rows, outputs}, 4);
    const at::Tensor out = layer(x, weight, bias);
    const auto found = torch::autograd::grad({out}, {x, weight, bias}, {grad});
    const at::Tensor rx = test::rounded(x.detach()), rw = test::rounded(weight.detach()),
                     rg = test::rounded(grad);
    const std::string shape = c10::str(rows, " x ", inputs, " -> ", outputs);
    EXPECT_LT(error(out.detach(), at::mm(rx, rw.t()) + bias.detach()), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[0], at::mm(rg, rw)), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[1], at::mm(rg.t(), rx)), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[2], grad.to(at::kDouble).sum(0)), tolerance(1e-6))
        << shape << ": not rounded";
  }
}

TEST_P(LinearAutocast, TakesLeadingAxesStridesAndNoBias) {
  const at::Tensor x = leaf(test::floats({3, 40, 64}, 1)), wide = leaf(test::floats({33, 64}, 2));
  const at::Tensor out = layer(x.transpose(0, 1).narrow(2, 32, 32), wide.narrow(1, 0, 32));
  const at::Tensor grad = test::floats({33, 3, 40}, 3).permute({2, 1, 0});
  const auto found = torch::autograd::grad({out}, {x, wide}, {grad});
  const at::Tensor
      rx = test::rounded(x.detach()).transpose(0, 1).narrow(2, 32, 32).reshape({120, 32}),
      rw = test::rounded(wide.detach()).narrow(1, 0, 32),
      rg = test::rounded(grad).reshape({120, 33});
  EXPECT_LT(error(out.detach(), at::mm(rx, rw.t()).view({40, 3, 33})), tolerance(1e-6));
  EXPECT_LT(error(found[0].narrow(2, 32, 32), at::mm(rg, rw).view({40, 3, 32}).transpose(0, 1)),
            tolerance(1e-6));
  EXPECT_EQ(found[0].narrow(2, 0, 32).abs().max().item<float>(), 0);
  EXPECT_LT(error(found[1].narrow(1, 0, 32), at::mm(rg.t(), rx)), tolerance(1e-6));
  const at::Tensor none = layer(x.narrow(1, 0, 0), wide);
  EXPECT_EQ(none.sizes(), (at::IntArrayRef{3, 0, 33}));
  EXPECT_EQ(torch::autograd::grad({none.sum()}, {wide})[0].abs().max().item<float>(), 0);
}

TEST_P(LinearAutocast, ThreadsChangeNothing) {
  const at::Tensor x = leaf(test::floats({20000, 40}, 1)),
                   weight = leaf(test::floats({150, 40}, 2)), grad = test::floats({20000, 150}, 3);
  const auto run = [&] {
    const at::Tensor out = layer(x, weight);
    auto all = torch::autograd::grad({out}, {x, weight}, {grad});
    all.push_back(out.detach());
    return all;
  };
  const auto one = test::with_threads(1, run), three = test::with_threads(3, run);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(at::equal(one[i], three[i])) << i;
}

TEST_P(LinearAutocast, IsTheSameWithoutGradientsAndThePlainLayerInFloat64) {
  const at::Tensor x = test::floats({50, 32}, 1), weight = leaf(test::floats({24, 32}, 2));
  at::Tensor without;
  {
    const at::NoGradGuard no_grad;
    without = layer(x, weight);
  }
  EXPECT_TRUE(at::equal(without, layer(x, weight).detach()));
  const at::Tensor exact = x.to(at::kDouble), w = leaf(weight.detach().to(at::kDouble));
  EXPECT_TRUE(at::equal(layer(exact, w).detach(), ops::linear(put(exact), put(w)).detach().cpu()));
  EXPECT_FALSE(
      at::equal(layer(x, weight).detach(), ops::linear(put(x), put(weight)).detach().cpu()));
  EXPECT_TRUE(test::throws_saying([&] { layer(x.narrow(1, 0, 31), weight); }, "[O, C]"));
}

TEST_P(LinearAutocast, IsNearFiniteDifferencesOfTheExactFormula) {
  const at::Tensor x = test::normal({3, 33}, 1), weight = test::normal({5, 33}, 2);
  const auto loss = [](const at::Tensor& out) { return out.mul(0.1).sin().sum(); };
  const at::Tensor fx = leaf(x.to(at::kFloat)), fw = leaf(weight.to(at::kFloat));
  const auto found = torch::autograd::grad({loss(layer(fx, fw))}, {fx, fw});
  const auto by_x = [&](const at::Tensor& t) { return loss(at::linear(t, weight)); };
  const auto by_weight = [&](const at::Tensor& t) { return loss(at::linear(x, t)); };
  // Each operand is off by 2^-9 at most.
  const auto expected = test::with_threads(1, [&] {
    return std::pair{test::numerical_gradient(by_x, x),
                     test::numerical_gradient(by_weight, weight)};
  });
  EXPECT_LT(error(found[0], expected.first), 0x1p-7);
  EXPECT_LT(error(found[1], expected.second), 0x1p-7);
}

TEST_P(LinearAutocast, WhatIsNotFiniteStaysVisible) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), INFINITY}) {
    const at::Tensor x = test::floats({40, 32}, 1), weight = leaf(test::floats({32, 32}, 2)),
                     y = x.clone();
    y[7][3] = bad;
    EXPECT_FALSE(layer(y, weight)[7].isfinite().any().item<bool>());
    const auto found = torch::autograd::grad({layer(x, weight)}, {weight}, {y.narrow(1, 0, 32)});
    EXPECT_FALSE(found[0][3].isfinite().any().item<bool>());
  }
}

TEST_P(SubmanifoldConvAutocast, RoundsWhatItsThreeProductsReadAndNothingElse) {
  const at::Tensor cells = test::integers(5, {91, 3}, 7, at::kInt);  // some share a cell
  const auto [pairs, begin] = convolution_pairs(cells, 3);
  for (const auto& [Cin, Cout] : {std::pair<int64_t, int64_t>{16, 16}, {48, 32}, {144, 160}}) {
    const at::Tensor input = leaf(test::floats({91, Cin}, 8)),
                     weight = leaf(test::floats({27, Cin, Cout}, 9)),
                     bias = leaf(test::floats({Cout}, 10)), grad = test::floats({91, Cout}, 11);
    const at::Tensor out = convolve(input, weight, bias, pairs, begin);
    const auto found = torch::autograd::grad({out}, {input, weight, bias}, {grad});
    const at::Tensor rx = leaf(test::rounded(input.detach())),
                     rw = leaf(test::rounded(weight.detach()));
    const at::Tensor exact = submanifold_conv(rx, rw, bias.detach().to(at::kDouble), pairs, begin);
    const auto expected = torch::autograd::grad({exact}, {rx, rw}, {test::rounded(grad)});
    const std::string shape = c10::str(Cin, " -> ", Cout);
    EXPECT_LT(error(out.detach(), exact.detach()), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[0], expected[0]), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[1], expected[1]), tolerance(1e-6)) << shape;
    EXPECT_LT(error(found[2], grad.to(at::kDouble).sum(0)), tolerance(1e-6)) << shape;
    const auto run = [&, p = pairs, b = begin] {
      return torch::autograd::grad({convolve(input, weight, bias, p, b)}, {input, weight}, {grad});
    };
    const auto threaded = test::with_threads(3, run);
    EXPECT_TRUE(at::equal(threaded[0], found[0]) && at::equal(threaded[1], found[1])) << shape;
  }
}

TEST_P(SubmanifoldConvAutocast, OddWidthsAreThePlainConvolution) {
  const at::Tensor cells = test::integers(4, {30, 3}, 7, at::kInt);
  const auto [pairs, begin] = convolution_pairs(cells, 3);
  const at::Tensor input = leaf(test::floats({30, 20}, 8)),
                   weight = leaf(test::floats({27, 20, 16}, 9));
  EXPECT_TRUE(
      at::equal(convolve(input, weight, {}, pairs, begin).detach(),
                submanifold_conv(put(input), put(weight), {}, put(pairs), begin).detach().cpu()));
}

}  // namespace
}  // namespace lte::ops
