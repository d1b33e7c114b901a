#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>

#include "tests/nn/support.h"

namespace lte::test {

void expect_gradients_match(const std::function<at::Tensor()>& f,
                            const std::vector<at::Tensor>& inputs, double tolerance) {
  constexpr double kStep = 1e-6;
  const auto gradients = torch::autograd::grad({f()}, inputs);
  const at::NoGradGuard no_grad;
  for (size_t i = 0; i < inputs.size(); ++i) {
    at::Tensor x = inputs[i];
    const at::Tensor direction = torch::randn_like(x);
    x.add_(direction, kStep);
    const double above = f().item<double>();
    x.sub_(direction, 2 * kStep);
    const double below = f().item<double>();
    x.add_(direction, kStep);
    const double numeric = (above - below) / (2 * kStep);
    const double analytic = (gradients[i] * direction).sum().item<double>();
    const double scale = 1 + std::abs(numeric);
    EXPECT_NEAR(analytic, numeric, tolerance * scale) << "input " << i << " of shape " << x.sizes();
    EXPECT_NE(analytic, 0) << "input " << i << " of shape " << x.sizes() << " has no influence";
  }
}

}  // namespace lte::test
