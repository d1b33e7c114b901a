// Patch attention with its gradient, against its definition in float64.
#include <algorithm>
#include <array>
#include <cmath>

#include "lte/ops/patch_attention.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/training_fixture.h"

namespace lte::ops {
namespace {

using test::is_of_rounding;
using test::leaf;
using test::wide_leaf;

/// Slots of patches, and which of them a point takes its result from.
struct Patches {
  at::Tensor gather, inverse;
  int64_t length = 0;
};

/// Points in a random order; the last patch repeats what slots one patch before hold.
Patches patches_of(int64_t n, int64_t length) {
  Patches out;
  out.length = length;
  const at::Tensor order = at::argsort(test::normal({n}, 21));
  const int64_t missing = (length - n % length) % length, end = n / length * length;
  out.gather =
      missing == 0 ? order : at::cat({order, order.slice(0, end - missing, end)}).contiguous();
  out.inverse = at::empty_like(order).scatter_(0, order, at::arange(n, at::kLong));
  return out;
}

/// Softmax attention as it is written down, of any dtype.
at::Tensor plain_attention(const at::Tensor& qkv, const Patches& patches, int64_t heads) {
  const bool one = !patches.gather.defined();
  const int64_t length = one ? qkv.size(0) : patches.length, d = qkv.size(1) / 3 / heads;
  const at::Tensor part = (one ? qkv : qkv.index_select(0, patches.gather))
                              .view({-1, length, 3, heads, d})
                              .permute({2, 0, 3, 1, 4});
  const at::Tensor weight = at::softmax(
      at::matmul(part[0], part[1].transpose(2, 3)) / std::sqrt(static_cast<double>(d)), -1);
  const at::Tensor out = at::matmul(weight, part[2]).transpose(1, 2).reshape({-1, qkv.size(1) / 3});
  return one ? out : out.index_select(0, patches.inverse);
}

void expect_attention_with_gradient(const at::Tensor& qkv, const Patches& patches, int64_t heads,
                                    double tolerance) {
  const at::Tensor exact = wide_leaf(qkv), single = leaf(qkv),
                   weight = test::normal({qkv.size(0), qkv.size(1) / 3}, 22);
  const at::Tensor expected = plain_attention(exact, patches, heads),
                   got = patch_attention(single, patches.gather, patches.inverse, heads,
                                         patches.length);
  EXPECT_LT(test::norm_error(got.detach(), expected.detach()), tolerance);
  expected.backward(weight);
  got.backward(weight.to(at::kFloat));
  for (const int64_t part : {0, 1, 2}) {
    const int64_t C = qkv.size(1) / 3;
    EXPECT_LT(
        test::norm_error(single.grad().narrow(1, part * C, C), exact.grad().narrow(1, part * C, C)),
        tolerance)
        << "part " << part << ", " << qkv.sizes() << ", heads " << heads << ", patch "
        << patches.length;
  }
}

TEST(TrainedPatchAttention, IsSoftmaxAttentionWithItsGradient) {
  // Sizes about a block, a panel of keys and a tile of queries.
  for (const auto& [n, C, heads] : {std::array<int64_t, 3>{2, 4, 1},
                                    {15, 6, 2},
                                    {48, 48, 3},
                                    {49, 40, 2},
                                    {129, 96, 6},
                                    {300, 128, 1}}) {
    expect_attention_with_gradient(2 * test::normal({n, 3 * C}, 20, at::kFloat), {}, heads, 5e-6);
  }
}

TEST(TrainedPatchAttention, AddsUpWhatTheSlotsOfAPointHave) {
  for (const auto& [n, length] : {std::array<int64_t, 2>{10, 4}, {12, 4}, {130, 50}, {200, 150}}) {
    expect_attention_with_gradient(test::normal({n, 96}, 23, at::kFloat), patches_of(n, length), 2,
                                   5e-6);
  }
}

TEST(TrainedPatchAttention, HasGradientsAtAnyScores) {
  // Scores of which some are known to be small and some are not, and such as leave one weight.
  for (const double gain : {0.01, 3.0, 6.0, 40.0}) {
    at::Tensor qkv = test::normal({150, 96}, 24, at::kFloat);
    qkv.narrow(1, 0, 32).mul_(gain);
    qkv.narrow(0, 100, 50).narrow(1, 0, 32).mul_(3);
    expect_attention_with_gradient(qkv, {}, 2, 5e-6 * std::max(1.0, gain));
  }
}

TEST(TrainedPatchAttention, OfOnePointIsItsValue) {
  const at::Tensor qkv = leaf(test::normal({1, 24}, 25, at::kFloat));
  const at::Tensor got = patch_attention(qkv, {}, {}, 2, 1);
  EXPECT_LT(test::norm_error(got.detach(), qkv.detach().narrow(1, 16, 8)), 1e-6);
  got.sum().backward();
  EXPECT_NEAR(qkv.grad().narrow(1, 0, 16).abs().max().item<float>(), 0, 1e-5);
  EXPECT_NEAR(qkv.grad().narrow(1, 16, 8).min().item<float>(), 1, 1e-6);
  EXPECT_EQ(patch_attention(at::empty({0, 24}, at::kFloat), {}, {}, 2, 1).size(0), 0);
}

TEST(TrainedPatchAttention, DoesNotDependOnThreads) {
  const Patches patches = patches_of(330, 100);
  const auto gradient = [&](int threads) {
    return test::with_threads(threads, [&] {
      const at::Tensor qkv = leaf(test::normal({330, 96}, 26, at::kFloat));
      patch_attention(qkv, patches.gather, patches.inverse, 2, 100).square().sum().backward();
      return qkv.grad();
    });
  };
  EXPECT_TRUE(at::equal(gradient(1), gradient(3)));
}

TEST(TrainedPatchAttention, InMixedPrecisionRoundsWhatProductsRead) {
  for (const auto& [n, C, heads] :
       {std::array<int64_t, 3>{15, 6, 2}, {129, 96, 6}, {200, 40, 2}, {300, 128, 1}}) {
    const Patches patches = patches_of(n, n / 2 + 3);
    const at::Tensor values = test::normal({n, 3 * C}, 20, at::kFloat), exact = wide_leaf(values),
                     weight = test::normal({n, C}, 22);
    plain_attention(exact, patches, heads).backward(weight);
    const auto run = [&, C = C, heads = heads](int threads) {
      return test::with_threads(threads, [&] {
        const at::Tensor qkv = leaf(values);
        const at::Tensor got =
            patch_attention(qkv, patches.gather, patches.inverse, heads, patches.length, true);
        EXPECT_TRUE(at::equal(
            got.detach(), patch_attention_inference(values, patches.gather, patches.inverse, heads,
                                                    patches.length, true)));
        got.backward(weight.to(at::kFloat));
        return qkv.grad();
      });
    };
    const at::Tensor grad = run(1);
    for (const int64_t part : {0, 1, 2}) {
      EXPECT_TRUE(is_of_rounding(
          test::norm_error(grad.narrow(1, part * C, C), exact.grad().narrow(1, part * C, C))))
          << "part " << part << ", C " << C;
    }
    EXPECT_TRUE(at::equal(run(3), grad));
  }
}

TEST(TrainedPatchAttention, RefusesBadInput) {
  const at::Tensor qkv = test::normal({4, 12}, 27, at::kFloat);
  EXPECT_TRUE(
      test::throws_saying([&] { patch_attention(qkv, {}, {}, 3, 1); }, "divided by 3 heads"));
  EXPECT_TRUE(
      test::throws_saying([&] { patch_attention(qkv.to(at::kDouble), {}, {}, 1, 1); }, "float32"));
}

}  // namespace
}  // namespace lte::ops
