#include "lte/ops/linear.h"

#include <utility>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>
#include <torch/autograd.h>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

struct Layer {
  at::Tensor x, weight, bias;
};

/// In double, for the reference.
Layer make_layer(std::vector<int64_t> leading, int64_t inputs, int64_t outputs) {
  const at::Generator generator = at::detail::createCPUGenerator(11);
  leading.push_back(inputs);
  const auto options = at::TensorOptions().dtype(at::kDouble);
  return {at::randn(leading, generator, options), at::randn({outputs, inputs}, generator, options),
          at::randn({outputs}, generator, options)};
}

double relative_error(const at::Tensor& a, const at::Tensor& b) {
  return ((a.cpu().to(at::kDouble) - b).abs().max() / b.abs().max()).item<double>();
}

class Linear : public test::PerDevice {
 protected:
  Layer float_layer(const Layer& layer) const {
    Layer out = {put(layer.x.to(at::kFloat)), put(layer.weight.to(at::kFloat)),
                 put(layer.bias.to(at::kFloat))};
    for (at::Tensor* t : {&out.x, &out.weight, &out.bias}) t->requires_grad_();
    return out;
  }

  void expect_products(const Layer& exact) const {
    const at::NoGradGuard no_grad;
    const Layer layer = float_layer(exact);
    const at::Tensor expected = at::matmul(exact.x, exact.weight.t());
    if (expected.numel() == 0) {
      EXPECT_EQ(ops::linear(layer.x, layer.weight, layer.bias).sizes(), expected.sizes());
      return;
    }
    const double most = tolerance(2e-6);
    EXPECT_LT(relative_error(ops::linear(layer.x, layer.weight), expected), most);
    EXPECT_LT(relative_error(ops::linear(layer.x, layer.weight, layer.bias), expected + exact.bias),
              most);
    EXPECT_LT(relative_error(linear_gelu(layer.x, layer.weight, layer.bias),
                             at::gelu(expected + exact.bias)),
              most);
  }

  /// y = x Wᵀ + b: dx = g W, dW = gᵀ x, db = Σ g.
  void expect_gradients(const Layer& exact) const {
    const Layer layer = float_layer(exact);
    const at::Tensor grad = at::cos(exact.x.sum(-1, true) + at::arange(96, exact.x.options()));
    ops::linear(layer.x, layer.weight, layer.bias).backward(put(grad.to(at::kFloat)));
    const at::Tensor g = grad.reshape({-1, 96}), x = exact.x.reshape({-1, 64});
    const double most = tolerance(3e-6);
    EXPECT_LT(relative_error(layer.x.grad().reshape({-1, 64}), at::mm(g, exact.weight)), most);
    EXPECT_LT(relative_error(layer.weight.grad(), at::mm(g.t(), x)), most);
    EXPECT_LT(relative_error(layer.bias.grad(), g.sum(0)), most);
  }
};
LTE_FOR_EACH_DEVICE(Linear);

const std::vector<std::vector<int64_t>> kLeading = {{0},   {1},    {3},     {255},     {256},
                                                    {257}, {1030}, {9, 32}, {7, 5, 33}};

const std::pair<int64_t, int64_t> kWidths[] = {{64, 64}, {96, 31}, {1, 130}, {128, 3}};

TEST_P(Linear, EqualsThePlainProductInDouble) {
  for (const auto& leading : kLeading) {
    for (const auto& [inputs, outputs] : kWidths) {
      expect_products(make_layer(leading, inputs, outputs));
    }
  }
}

TEST_P(Linear, TakesStridedFactors) {
  const Layer exact = make_layer({1024}, 128, 64);
  const at::NoGradGuard no_grad;
  const at::Tensor wide = put(exact.weight.to(at::kFloat)), x = put(exact.x.to(at::kFloat));
  EXPECT_LT(relative_error(ops::linear(x.narrow(1, 64, 64), wide.narrow(1, 64, 64)),
                           at::mm(exact.x.narrow(1, 64, 64), exact.weight.narrow(1, 64, 64).t())),
            tolerance(2e-6));
  const at::Tensor turned = x.t().contiguous().t();
  EXPECT_LT(relative_error(ops::linear(turned, wide), at::mm(exact.x, exact.weight.t())),
            tolerance(2e-6));
}

TEST_P(Linear, GradientsEqualThoseOfTheFormulaInDouble) {
  for (const auto& leading : kLeading) {
    const Layer exact = make_layer(leading, 64, 96);
    if (exact.x.numel() > 0) expect_gradients(exact);
  }
}

TEST(LinearOnTheCpu, RowsDoNotSeeEachOtherAndThreadsChangeNothing) {
  const at::NoGradGuard no_grad;
  const at::Tensor x = test::normal({300, 70}, 4, at::kFloat),
                   weight = test::normal({140, 70}, 5, at::kFloat);
  const at::Tensor all = ops::linear(x, weight);
  for (const int64_t row : {0, 95, 96, 299}) {
    EXPECT_TRUE(at::equal(ops::linear(x.narrow(0, row, 1), weight)[0], all[row])) << row;
    EXPECT_TRUE(at::equal(ops::linear(x[row], weight), all[row])) << row;
  }
  EXPECT_TRUE(at::equal(test::with_threads(1, [&] { return ops::linear(x, weight); }), all));
  EXPECT_EQ(ops::linear(x.narrow(1, 0, 0), weight.narrow(1, 0, 0)).sizes(),
            (at::IntArrayRef{300, 140}));
}

TEST_P(Linear, AsksForNoGradientThatIsNotWanted) {
  Layer layer = float_layer(make_layer({1024}, 64, 64));
  layer.x.requires_grad_(false);
  ops::linear(layer.x, layer.weight).sum().backward();
  EXPECT_FALSE(layer.x.grad().defined());
  EXPECT_TRUE(layer.weight.grad().defined());
  EXPECT_FALSE(layer.bias.grad().defined());
}

TEST_P(Linear, DoubleGoesThroughAndWrongShapesAreRefused) {
  const Layer exact = make_layer({1024}, 64, 64);
  EXPECT_EQ(ops::linear(put(exact.x), put(exact.weight)).scalar_type(), at::kDouble);
  const Layer layer = float_layer(exact);
  const auto refused = [](const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias,
                          const char* words) {
    return test::throws_saying([&] { ops::linear(x, weight, bias); }, words) &&
           test::throws_saying([&] { linear_gelu(x, weight, bias); }, words) &&
           test::throws_saying([&] { linear_autocast(x, weight, bias); }, words);
  };
  EXPECT_TRUE(refused(layer.x, layer.weight.narrow(1, 0, 63), {}, "weight [O, C]"));
  EXPECT_TRUE(refused(layer.x, layer.weight[0], {}, "weight [O, C]"));
  EXPECT_TRUE(refused(layer.x, layer.weight, layer.bias.narrow(0, 0, 63), "bias must be [64]"));
}

}  // namespace
}  // namespace lte::ops
