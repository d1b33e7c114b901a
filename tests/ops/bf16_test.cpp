// Operators with bfloat16 weights against the same formulas in float64 with operands rounded to
// bfloat16 wherever a product reads them, and against float32.
#include "lte/ops/bf16.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "lte/ops/dispatch.h"
#include "lte/ops/linear.h"
#include "lte/ops/neighbour_max.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/patch_attention.h"
#include "lte/ops/query_decoder.h"
#include "lte/ops/submanifold_conv.h"
#include "tests/ops/decoder_fixture.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

// Sizes about a pair, a block and a panel of channels, and about a tile of rows.
const std::vector<std::array<int64_t, 3>> kProducts = {
    {1, 1, 1},    {3, 2, 17},      {95, 15, 16}, {96, 128, 128},
    {97, 127, 3}, {200, 129, 130}, {13, 257, 31}};

class LinearBf16 : public test::PerDevice {
 protected:
  /// A layer run on this device, on the CPU.
  at::Tensor layer(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias = {},
                   bool activated = false) const {
    return (activated ? linear_gelu(put(x), put(weight), put(bias))
                      : ops::linear(put(x), put(weight), put(bias)))
        .cpu();
  }
};
LTE_FOR_EACH_DEVICE(LinearBf16);

TEST_P(LinearBf16, IsTheProductOfRoundedOperands) {
  for (const auto& [rows, inputs, outputs] : kProducts) {
    const at::Tensor x = test::floats({rows, inputs}, 1),
                     weight = test::floats({outputs, inputs}, 2), bias = test::floats({outputs}, 3);
    const at::Tensor product = at::matmul(test::rounded(x), test::rounded(weight).t());
    const at::Tensor half = weight.to(at::kBFloat16);
    EXPECT_LT(test::norm_error(layer(x, half), product), tolerance(1e-6))
        << rows << " x " << inputs;
    const at::Tensor expected = product + bias.to(at::kDouble);
    EXPECT_LT(test::norm_error(layer(x, half, bias), expected), tolerance(1e-6))
        << rows << " x " << inputs;
    const at::Tensor activated = layer(x, half, bias, true).to(at::kDouble);
    EXPECT_LT((activated - at::gelu(expected)).abs().max().item<double>(), 3e-4);
    EXPECT_EQ(layer(x, half).scalar_type(), at::kFloat);
  }
}

TEST_P(LinearBf16, RoundsTiesToEvenAndKeepsWhatIsRepresentable) {
  // 1 + 2^-8 lies between two neighbours of 8 bits, as does 1 + 3 · 2^-8.
  const at::Tensor x = at::tensor({1.0f, 1 + 0x1p-8f, 1 + 0x3p-8f, -0x1p-100f, 3e38f, 0.0f});
  const at::Tensor one = at::ones({1, 1}, at::kBFloat16);
  const at::Tensor expected =
      at::tensor({1.0f, 1.0f, 1 + 0x1p-6f, -0x1p-100f, x.to(at::kBFloat16)[4].item<float>(), 0.0f});
  EXPECT_TRUE(at::equal(layer(x.unsqueeze(1), one).squeeze(1), expected));
}

TEST(LinearBf16OnTheCpu, RowsDoNotSeeEachOtherAndThreadsChangeNothing) {
  const at::Tensor x = test::floats({300, 70}, 4),
                   weight = test::floats({140, 70}, 5).to(at::kBFloat16);
  const at::Tensor all = ops::linear(x, weight);
  for (const int64_t row : {0, 95, 96, 299}) {
    EXPECT_TRUE(at::equal(ops::linear(x.narrow(0, row, 1), weight)[0], all[row])) << row;
  }
  EXPECT_TRUE(at::equal(test::with_threads(1, [&] { return ops::linear(x, weight); }), all));
  EXPECT_EQ(ops::linear(x.narrow(0, 0, 0), weight).sizes(), (at::IntArrayRef{0, 140}));
}

TEST_P(LinearBf16, RefusesBadInput) {
  const at::Tensor x = test::floats({2, 3}, 2), weight = test::floats({4, 3}, 1).to(at::kBFloat16);
  const auto refused = [this](const at::Tensor& rows, const at::Tensor& w, const at::Tensor& bias,
                              const char* words) {
    return test::throws_saying([&] { layer(rows, w, bias); }, words);
  };
  EXPECT_TRUE(refused(test::floats({2, 5}, 2), weight, {}, "x must be"));
  EXPECT_TRUE(refused(x, weight[0], {}, "weight [O, C]"));
  EXPECT_TRUE(refused(x, weight, test::floats({5}, 3), "bias must be [4]"));
  EXPECT_TRUE(refused(x, weight, test::floats({4}, 3).to(at::kDouble), "bias must be float32"));
  if (on_cpu()) return;
  EXPECT_TRUE(test::throws_saying([&] { ops::linear(put(x), weight); }, "weights on cpu"));
}

TEST_P(LinearBf16, TheGradientByTheWeightRefusesBadInput) {
  static const auto gradient =
      find_operator<at::Tensor(const at::Tensor&, const at::Tensor&)>("lte::weight_gradient");
  const at::Tensor grad = test::floats({7, 4}, 1), x = test::floats({7, 3}, 2).to(at::kBFloat16);
  const auto refused = [&](const at::Tensor& g, const at::Tensor& rows, const char* words) {
    return test::throws_saying([&] { gradient.call(g, rows); }, words);
  };
  EXPECT_EQ(gradient.call(put(grad), put(x)).sizes(), (at::IntArrayRef{4, 3}));
  EXPECT_TRUE(refused(put(grad).to(at::kDouble), put(x), "grad must be [N, O] float32"));
  EXPECT_TRUE(refused(put(grad.t().contiguous()).t(), put(x), "contiguous"));
  EXPECT_TRUE(refused(put(grad), put(x).narrow(0, 0, 6), "x must be [7, C]"));
  EXPECT_TRUE(refused(put(grad), put(x).to(at::kDouble), "float32 or bfloat16"));
}

TEST(NeighbourMaxBf16, IsTheMaximumOfRoundedProducts) {
  const at::Tensor dense = test::floats({60, 130}, 1), center = test::floats({20, 130}, 2),
                   weight = test::floats({257, 130}, 3), bias = test::floats({257}, 4),
                   neighbour = test::integers(60, {20, 7}, 5);
  const at::Tensor pair = at::gelu(
      (dense.index_select(0, neighbour.view({-1})).view({20, 7, 130}) + center.unsqueeze(1))
          .to(at::kDouble));
  const at::Tensor expected =
      at::amax(at::linear(test::rounded(pair), test::rounded(weight), bias.to(at::kDouble)), {1});
  const at::Tensor got =
      neighbour_max_inference(dense, center, neighbour, weight.to(at::kBFloat16), bias);
  // GELU differs by 2 · 10^-4, a tenth of a rounding.
  EXPECT_LT(test::norm_error(got, expected), 1e-3);
}

TEST(PatchAttentionBf16, IsNearSoftmaxAttention) {
  for (const auto& [n, C, heads] :
       {std::array<int64_t, 3>{1, 4, 1}, {17, 6, 2}, {129, 40, 2}, {300, 128, 4}}) {
    const at::Tensor qkv = test::floats({n, 3 * C}, 6);
    const int64_t d = C / heads;
    const at::Tensor parts = qkv.view({n, 3, heads, d}).permute({1, 2, 0, 3});
    // Scores are in units of log 2, and none of these is so large that one has to be subtracted.
    const float scale = std::numbers::log2e_v<float> / std::sqrt(static_cast<float>(d));
    const at::Tensor score =
        at::matmul(test::rounded(parts[0] * scale), test::rounded(parts[1]).transpose(1, 2));
    const at::Tensor weight = at::exp2(score);
    const at::Tensor expected =
        (at::matmul(test::rounded(weight), test::rounded(parts[2])) / weight.sum(-1, true))
            .transpose(0, 1)
            .reshape({n, C});
    EXPECT_LT(test::norm_error(patch_attention_inference(qkv, {}, {}, heads, 1, true), expected),
              1e-4)
        << n << " " << C;
  }
}

class SubmanifoldConvBf16 : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(SubmanifoldConvBf16);

TEST_P(SubmanifoldConvBf16, IsTheSumOfRoundedProducts) {
  const at::Tensor cells = test::integers(5, {90, 3}, 7, at::kInt);
  const auto [pairs, begin] = convolution_pairs(cells, 3);
  for (const auto& [Cin, Cout] : {std::pair<int64_t, int64_t>{16, 16}, {31, 48}, {130, 144}}) {
    const at::Tensor input = test::floats({90, Cin}, 8), weight = test::floats({27, Cin, Cout}, 9),
                     bias = test::floats({Cout}, 10);
    const at::Tensor expected = submanifold_conv(test::rounded(input), test::rounded(weight),
                                                 bias.to(at::kDouble), pairs, begin);
    const at::Tensor got =
        submanifold_conv(put(input), put(weight.to(at::kBFloat16)), put(bias), put(pairs), begin);
    EXPECT_LT(test::norm_error(got.cpu(), expected), tolerance(1e-6)) << Cin << " -> " << Cout;
  }
  EXPECT_TRUE(test::throws_saying(
      [&, p = pairs, b = begin] {
        submanifold_conv(put(test::floats({90, 16}, 8)),
                         put(test::floats({27, 16, 5}, 9).to(at::kBFloat16)), {}, put(p), b);
      },
      "multiple of 16"));
}

TEST(QueryDecoderBf16, IsNearFloat32AndDoesNotDependOnThreads) {
  for (const auto& [C, hidden, K] : {std::array<int64_t, 3>{20, 31, 9}, {128, 150, 32}}) {
    const int64_t Q = 250, m = 60, L = 3;
    const DecoderWeights weights = test::decoder_weights(9, C, L, hidden),
                         half = test::in_bf16(weights);
    const at::Tensor keys = test::floats({L, m, C}, 11), values = test::floats({L, m, C}, 12);
    const at::Tensor table = neighbour_table(keys, values), attributes = test::floats({Q, 9}, 13);
    const QueryNeighbourhood near{test::uniform({Q, 3}, 14), test::uniform({m, 3}, 15),
                                  test::integers(m, {Q, K}, 16), 4, 64};
    const at::Tensor single = query_decoder_inference(attributes, near, table, weights);
    const auto answer = [&] { return query_decoder_inference(attributes, near, table, half); };
    const at::Tensor got = answer();
    EXPECT_LT(
        test::norm_error(single, test::decoder_reference(attributes, near, keys, values, weights)),
        2e-6);
    // GELU's 2 · 10^-4, and roundings that it tips to the other side, remain.
    EXPECT_LT(test::norm_error(got, test::decoder_reference(attributes, near, keys, values, half)),
              2.5e-3);
    const double by_rounding = test::norm_error(got, single.to(at::kDouble));
    EXPECT_GT(by_rounding, 1e-4);
    EXPECT_LT(by_rounding, 2e-2);
    EXPECT_TRUE(at::equal(test::with_threads(1, answer), got));
  }
}

TEST(Bf16, IsInHardwareUnlessALesserInstructionSetIsAskedFor) {
  const char* variable = std::getenv("LTE_CPU_ISA");
  const std::string asked = variable == nullptr ? "" : variable;
  bool possible = false;
#if defined(__x86_64__)
  possible = __builtin_cpu_supports("avx512bf16") != 0;
#endif
  const bool allowed = asked.empty() || asked == "amx" || asked == "avx512_bf16";
  EXPECT_EQ(has_bf16_products(), possible && allowed);
}

}  // namespace
}  // namespace lte::ops
