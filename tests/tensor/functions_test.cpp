// Functions of tensors, of whichever the build has.
#include "lte/tensor/functions.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/tensor/tensor.h"

namespace lte {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

template <typename T>
std::vector<T> numbers(const at::Tensor& t) {
  const at::Tensor dense = t.contiguous();
  const auto* values = dense.const_data_ptr<T>();
  return std::vector<T>(values, values + dense.numel());
}

at::Tensor floats(const std::vector<float>& values) {
  return at::tensor(values, at::TensorOptions(at::kFloat));
}
at::Tensor whole(const std::vector<int64_t>& values) {
  return at::tensor(values, at::TensorOptions(at::kLong));
}

TEST(TensorFunctions, JoinAndPad) {
  const at::Tensor a = floats({1, 2, 3, 4}).view({2, 2}), b = floats({5, 6}).view({2, 1});
  EXPECT_THAT(numbers<float>(at::cat({a, b}, 1)), ElementsAre(1, 2, 5, 3, 4, 6));
  EXPECT_THAT(numbers<float>(at::cat({a, a.t()})), ElementsAre(1, 2, 3, 4, 1, 3, 2, 4));
  EXPECT_THAT(numbers<float>(at::stack({a[0], a[1]}, 1)), ElementsAre(1, 3, 2, 4));
  EXPECT_THAT(numbers<float>(at::constant_pad_nd(b, {0, 1, 1, 0})), ElementsAre(0, 0, 5, 0, 6, 0));
  EXPECT_THAT(numbers<float>(b.view({-1}).repeat({2})), ElementsAre(5, 6, 5, 6));
  EXPECT_THAT(numbers<int64_t>(at::repeat_interleave(whole({2, 0, 1}))), ElementsAre(0, 0, 2));
  EXPECT_THAT(numbers<int64_t>(at::arange(2, 5, at::TensorOptions(at::kLong))),
              ElementsAre(2, 3, 4));
}

TEST(TensorFunctions, OrderAndCounts) {
  const auto [sorted, order] = at::sort(whole({3, 1, 3, 1, 2}), /*stable=*/true, 0, false);
  EXPECT_THAT(numbers<int64_t>(sorted), ElementsAre(1, 1, 2, 3, 3));
  EXPECT_THAT(numbers<int64_t>(order), ElementsAre(1, 3, 4, 0, 2));
  const auto [unique, inverse, counts] = at::unique_consecutive(sorted, true, true);
  EXPECT_THAT(numbers<int64_t>(unique), ElementsAre(1, 2, 3));
  EXPECT_THAT(numbers<int64_t>(inverse), ElementsAre(0, 0, 1, 2, 2));
  EXPECT_THAT(numbers<int64_t>(counts), ElementsAre(2, 1, 2));
  EXPECT_THAT(numbers<int64_t>(counts.cumsum(0)), ElementsAre(2, 3, 5));
  EXPECT_THAT(numbers<int64_t>(at::bincount(whole({1, 3, 1}), {}, 5)), ElementsAre(0, 2, 0, 1, 0));
}

TEST(TensorFunctions, ExtremesOfGroups) {
  const at::Tensor x = floats({1, 8, 5, 2, NAN, 4}).view({3, 2});
  const at::Tensor group = whole({0, 0, 1}).unsqueeze(1).expand({3, 2});
  const at::Tensor least = at::full({3, 2}, -INFINITY);
  const std::vector<float> most = numbers<float>(least.scatter_reduce(0, group, x, "amax"));
  EXPECT_EQ(most[0], 5);
  EXPECT_EQ(most[1], 8);
  EXPECT_TRUE(std::isnan(most[2]));
  EXPECT_EQ(most[3], 4);
  EXPECT_EQ(most[4], -INFINITY) << "a group without rows";
  EXPECT_THAT(numbers<int64_t>(at::full({1, 2}, 9, at::TensorOptions(at::kLong))
                                   .scatter_reduce(0, whole({0, 0, 0, 0}).view({2, 2}),
                                                   whole({4, 3, 2, 7}).view({2, 2}), "amin")),
              ElementsAre(2, 3));
}

TEST(TensorFunctions, Products) {
  const at::Tensor a = floats({1, 2, 3, 4, 5, 6}).view({1, 2, 3});
  EXPECT_THAT(numbers<float>(at::bmm(a, a.transpose(1, 2))), ElementsAre(14, 32, 32, 77));
  EXPECT_THAT(numbers<float>(at::mv(a[0].t(), floats({1, 10}))), ElementsAre(41, 52, 63));
  EXPECT_THAT(numbers<float>(at::linear(a, floats({1, 0, -1}).view({1, 3}), floats({0.5F}))),
              ElementsAre(-1.5F, -1.5F));
}

TEST(TensorFunctions, NormsAndWeights) {
  const at::Tensor x = floats({1, 2, 3, 6}).view({2, 2});
  const std::vector<float> normed =
      numbers<float>(at::layer_norm(x, {2}, floats({1, 2}), floats({0, 1}), 0));
  EXPECT_THAT(normed, ElementsAre(FloatNear(-1, 1e-6F), FloatNear(3, 1e-6F), FloatNear(-1, 1e-6F),
                                  FloatNear(3, 1e-6F)));
  const float e = 1 / (1 + std::exp(1.F));
  EXPECT_THAT(numbers<float>(at::softmax(x, 1)),
              ElementsAre(FloatNear(e, 1e-6F), FloatNear(1 - e, 1e-6F),
                          FloatNear(1 / (1 + std::exp(3.F)), 1e-6F),
                          FloatNear(1 - 1 / (1 + std::exp(3.F)), 1e-6F)));
  EXPECT_NEAR(at::log_softmax(x, 0)[0][0].item<float>(), -2.126928F, 1e-5F);
  EXPECT_NEAR(at::softplus(floats({0}))[0].item<float>(), std::log(2.F), 1e-6F);
  EXPECT_NEAR(at::gelu(floats({1}))[0].item<float>(), 0.8413447F, 1e-6F);
  // One key has all the weight, whatever the query.
  const at::Tensor q = x.view({1, 1, 2, 2}), k = q.narrow(2, 0, 1), v = q.narrow(2, 1, 1);
  EXPECT_THAT(numbers<float>(at::scaled_dot_product_attention(q, k, v)), ElementsAre(3, 6, 3, 6));
}

}  // namespace
}  // namespace lte
