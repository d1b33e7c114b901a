#include "lte/nn/loss.h"

#include <cmath>

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>

#include "tests/nn/support.h"

namespace lte::nn {
namespace {

TEST(LogRelativeLoss, MatchesValuesByHand) {
  // log 2 against log 1, and log 4 against log 2 = half of it, with epsilon 1.
  const at::Tensor predicted = torch::tensor({{1.0, 3.0, 0.0}}, at::kDouble);
  const at::Tensor target = torch::tensor({{0.0, 1.0, 0.0}}, at::kDouble);
  const double a = std::log(2.0) / (std::log(2.0) + 1), b = std::log(2.0) / (std::log(4.0) + 1);
  for (const bool detach : {false, true}) {
    const LossConfig config{.epsilon = 1, .detach_denominator = detach};
    EXPECT_NEAR(relative_loss(predicted, target, config).item<double>(), (a * a + b * b) / 3,
                1e-14);
  }
}

TEST(LogRelativeLoss, GradientsMatchFiniteDifferences) {
  torch::manual_seed(1);
  const at::Tensor predicted = torch::rand({9, 3}, at::kDouble).requires_grad_();
  const at::Tensor target = torch::rand({9, 3}, at::kDouble);
  test::expect_gradients_match([&] { return relative_loss(predicted, target, {}); }, {predicted});
}

TEST(LogRelativeLoss, DetachedDenominatorIsAConstant) {
  const at::Tensor predicted = torch::tensor({{2.0, 2.0, 2.0}}, at::kDouble).requires_grad_();
  const at::Tensor target = torch::tensor({{1.0, 1.0, 1.0}}, at::kDouble);
  const LossConfig config{.epsilon = 0.5, .detach_denominator = true};
  const at::Tensor gradient =
      torch::autograd::grad({relative_loss(predicted, target, config)}, {predicted})[0];
  const double denominator = std::log(3.0) + 0.5;
  const double expected =
      2 * (std::log(3.0) - std::log(2.0)) / 3.0 / (denominator * denominator) / 3;
  EXPECT_NEAR(gradient[0][0].item<double>(), expected, 1e-14);
}

TEST(LinearRelativeLoss, IsLeastAtTheMeanOfNoisyReferences) {
  const at::Tensor noisy = torch::tensor({{1.0, 2.0, 0.0}, {3.0, 2.0, 9.0}}, at::kDouble);
  const at::Tensor mean = noisy.mean(0).expand({2, 3}).clone().requires_grad_();
  const LossConfig config{.epsilon = 0.3, .detach_denominator = true, .space = LossSpace::Linear};
  const at::Tensor loss = relative_loss(mean, noisy, config);
  EXPECT_NEAR(loss.item<double>(), (1 / (2.3 * 2.3) + std::pow(4.5 / 4.8, 2)) / 3, 1e-12);
  const at::Tensor gradient = torch::autograd::grad({loss}, {mean})[0].sum(0);
  EXPECT_LT(gradient.abs().max().item<double>(), 1e-15);
}

TEST(RelativeLoss, RefusesWhatItCannotAverage) {
  const at::Tensor one = torch::ones({1, 3});
  test::expect_error([&] { relative_loss(one, torch::ones({2, 3}), {}); }, {"[1, 3]", "[2, 3]"});
  test::expect_error(
      [] {
        relative_loss(torch::ones({0, 3}), torch::ones({0, 3}), {});
      },
      {"no samples"});
  test::expect_error([&] { relative_loss(one, one, {.epsilon = 0}); }, {"epsilon"});
}

}  // namespace
}  // namespace lte::nn
