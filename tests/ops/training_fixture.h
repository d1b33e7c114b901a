// Leaves of gradients, in float32 and float64.
#pragma once

#include <ATen/core/Tensor.h>
#include <gtest/gtest.h>

namespace lte::ops::test {

/// Wants gradients from now on.
inline at::Tensor leaf(const at::Tensor& t) { return t.detach().clone().requires_grad_(); }
inline at::Tensor wide_leaf(const at::Tensor& t) {
  return t.detach().to(at::kDouble).clone().requires_grad_();
}

/// Whether an error is that of bfloat16's eight bits: neither none nor more.
inline testing::AssertionResult is_of_rounding(double error) {
  if (error > 2e-4 && error < 4e-2) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "an error of " << error;
}

}  // namespace lte::ops::test
