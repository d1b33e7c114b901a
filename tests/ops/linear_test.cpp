#include "lte/ops/linear.h"

#include <ATen/ATen.h>
#include <gtest/gtest.h>
#include <torch/autograd.h>

namespace lte::ops {
namespace {

struct Layer {
  at::Tensor x, weight, bias;
};

/// Both sides of the size at which products change their path, in double for the reference.
Layer make_layer(std::vector<int64_t> leading, int64_t inputs, int64_t outputs) {
  const at::Generator generator = at::detail::createCPUGenerator(11);
  leading.push_back(inputs);
  const auto options = at::TensorOptions().dtype(at::kDouble);
  return {at::randn(leading, generator, options), at::randn({outputs, inputs}, generator, options),
          at::randn({outputs}, generator, options)};
}

Layer to_float(const Layer& layer) {
  Layer out = {layer.x.to(at::kFloat), layer.weight.to(at::kFloat), layer.bias.to(at::kFloat)};
  for (at::Tensor* t : {&out.x, &out.weight, &out.bias}) t->requires_grad_();
  return out;
}

double relative_error(const at::Tensor& a, const at::Tensor& b) {
  return ((a.to(at::kDouble) - b).abs().max() / b.abs().max()).item<double>();
}

const std::vector<std::vector<int64_t>> kLeading = {{0},   {1},    {3},     {255},     {256},
                                                    {257}, {1030}, {9, 32}, {7, 5, 33}};

TEST(Linear, EqualsThePlainProductInDouble) {
  for (const auto& leading : kLeading) {
    for (const auto& [inputs, outputs] : {std::pair{64, 64}, {96, 31}, {1, 130}, {128, 3}}) {
      const Layer exact = make_layer(leading, inputs, outputs);
      const at::NoGradGuard no_grad;
      const Layer layer = to_float(exact);
      const at::Tensor expected = at::matmul(exact.x, exact.weight.t());
      if (expected.numel() == 0) {
        EXPECT_EQ(ops::linear(layer.x, layer.weight, layer.bias).sizes(), expected.sizes());
        continue;
      }
      EXPECT_LT(relative_error(ops::linear(layer.x, layer.weight), expected), 2e-6);
      EXPECT_LT(
          relative_error(ops::linear(layer.x, layer.weight, layer.bias), expected + exact.bias),
          2e-6);
      EXPECT_LT(relative_error(linear_gelu(layer.x, layer.weight, layer.bias),
                               at::gelu(expected + exact.bias)),
                2e-6);
    }
  }
}

TEST(Linear, TakesStridedFactors) {
  const Layer exact = make_layer({1024}, 128, 64);
  const at::NoGradGuard no_grad;
  const at::Tensor wide = exact.weight.to(at::kFloat);
  const at::Tensor x = exact.x.to(at::kFloat);
  EXPECT_LT(relative_error(ops::linear(x.narrow(1, 64, 64), wide.narrow(1, 64, 64)),
                           at::mm(exact.x.narrow(1, 64, 64), exact.weight.narrow(1, 64, 64).t())),
            2e-6);
  const at::Tensor turned = x.t().contiguous().t();
  EXPECT_LT(relative_error(ops::linear(turned, wide), at::mm(exact.x, exact.weight.t())), 2e-6);
}

TEST(Linear, GradientsEqualThoseOfTheFormulaInDouble) {
  for (const auto& leading : kLeading) {
    const Layer exact = make_layer(leading, 64, 96);
    if (exact.x.numel() == 0) continue;
    Layer layer = to_float(exact);
    const at::Tensor grad = at::cos(exact.x.sum(-1, true) + at::arange(96, exact.x.options()));
    const at::Tensor out = ops::linear(layer.x, layer.weight, layer.bias);
    out.backward(grad.to(at::kFloat));
    // y = x Wᵀ + b: dx = g W, dW = gᵀ x, db = Σ g.
    const at::Tensor g = grad.reshape({-1, 96}), x = exact.x.reshape({-1, 64});
    EXPECT_LT(relative_error(layer.x.grad().reshape({-1, 64}), at::mm(g, exact.weight)), 3e-6);
    EXPECT_LT(relative_error(layer.weight.grad(), at::mm(g.t(), x)), 3e-6);
    EXPECT_LT(relative_error(layer.bias.grad(), g.sum(0)), 3e-6);
  }
}

TEST(Linear, AsksForNoGradientThatIsNotWanted) {
  const Layer exact = make_layer({1024}, 64, 64);
  Layer layer = to_float(exact);
  layer.x.requires_grad_(false);
  ops::linear(layer.x, layer.weight).sum().backward();
  EXPECT_FALSE(layer.x.grad().defined());
  EXPECT_TRUE(layer.weight.grad().defined());
  EXPECT_FALSE(layer.bias.grad().defined());
}

TEST(Linear, DoubleGoesThroughAndAWrongWidthIsRefused) {
  const Layer exact = make_layer({1024}, 64, 64);
  EXPECT_EQ(ops::linear(exact.x, exact.weight).scalar_type(), at::kDouble);
  EXPECT_THROW(ops::linear(exact.x.to(at::kFloat), exact.weight.narrow(1, 0, 63).to(at::kFloat)),
               c10::Error);
}

}  // namespace
}  // namespace lte::ops
