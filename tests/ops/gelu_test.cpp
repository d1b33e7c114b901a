#include "lte/ops/gelu.h"

#include <limits>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

/// Every scale, both signs, and lengths that leave a rest after whole vectors.
at::Tensor values(int64_t count) {
  const at::Tensor scale = at::pow(10.0, test::uniform({count}, 41, at::kDouble) * 12 - 10);
  return at::cat({test::normal({count}, 42) * scale, at::linspace(-8, 8, 1601, at::kDouble),
                  at::tensor({0.0, -0.0, 5.656, 5.657, -5.656, -5.657, 1e30, -1e30}, at::kDouble)});
}

class Gelu : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(Gelu);

TEST_P(Gelu, EqualsTheExactFormInDoubleWithItsGradient) {
  for (const int64_t count : {1, 15, 16, 40000}) {
    const at::Tensor exact = values(count).to(at::kFloat).to(at::kDouble).requires_grad_();
    const at::Tensor x = exact.detach().to(at::kFloat).requires_grad_();
    const at::Tensor weight = test::normal({x.numel()}, 43);
    const at::Tensor expected = at::gelu(exact), y = ops::gelu(put(x)).cpu();
    expected.backward(weight);
    y.backward(weight.to(at::kFloat));
    const at::Tensor limit = exact.detach().abs().clamp_min(1) * 1e-6;
    EXPECT_TRUE(((y.to(at::kDouble) - expected).abs() <= limit).all().item<bool>());
    const at::Tensor difference = (x.grad().to(at::kDouble) - exact.grad()).abs();
    EXPECT_TRUE((difference <= weight.abs().clamp_min(1) * 1e-6).all().item<bool>())
        << difference.max().item<double>();
  }
}

TEST_P(Gelu, KeepsWhatIsNotANumberVisible) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const at::Tensor x = put(at::full({19}, nan)).requires_grad_();
  const at::Tensor y = ops::gelu(x);
  EXPECT_TRUE(y.isnan().all().item<bool>());
  y.sum().backward();
  EXPECT_TRUE(x.grad().isnan().all().item<bool>());
}

TEST_P(Gelu, TakesAnyShapeStrideAndFloatingType) {
  const at::Tensor x = put(test::normal({6, 5}, 44));
  EXPECT_EQ(ops::gelu(x.to(at::kFloat).t()).sizes(), x.t().sizes());
  EXPECT_LT(test::relative_error(ops::gelu(x.to(at::kFloat).t()), at::gelu(x.t())), 1e-6);
  EXPECT_LT(test::relative_error(ops::gelu(x), at::gelu(x)), 1e-15);
  EXPECT_EQ(ops::gelu(put(at::empty({0, 3}))).sizes(), at::IntArrayRef({0, 3}));
}

TEST_P(Gelu, RefusesWhatIsNotFloatingPoint) {
  EXPECT_TRUE(test::throws_saying([&] { ops::gelu(put(at::ones({3}, at::kLong))); },
                                  "x must be floating point"));
}

TEST_P(Gelu, DoesNotDependOnThreads) {
  const at::Tensor x = put(test::normal({100001}, 45).to(at::kFloat));
  EXPECT_TRUE(at::equal(test::with_threads(1, [&] { return ops::gelu(x); }),
                        test::with_threads(3, [&] { return ops::gelu(x); })));
}

}  // namespace
}  // namespace lte::ops
