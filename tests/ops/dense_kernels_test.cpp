// The vector loops of dense layers, norms and softmax against plain loops in float64.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "lte/ops/cpu/kernels/kernels.h"
#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

/// A tile of some rows of `columns`, with room for whole panels; what is past the last is `rest`.
struct Rows {
  int64_t rows, columns, panels;
  std::vector<float> values;

  Rows(int64_t row_count, int64_t column_count, const at::Tensor& from, float rest)
      : rows(row_count),
        columns(column_count),
        panels((columns + kPanel - 1) / kPanel),
        values(static_cast<size_t>(panels * rows * kPanel), rest) {
    const at::Tensor dense = from.to(at::kFloat).contiguous();
    for (int64_t r = 0; r < rows; ++r) {
      for (int64_t c = 0; c < columns; ++c)
        at(r, c) = dense.const_data_ptr<float>()[r * columns + c];
    }
  }

  float& at(int64_t r, int64_t c) {
    return values[static_cast<size_t>(c / kPanel * stride() + r * kPanel + c % kPanel)];
  }
  int64_t stride() const { return rows * kPanel; }
};

TEST(DenseKernels, GeluIsTheExactOneToAFewRoundings) {
  constexpr int64_t kCount = 200'003;  // several to every interval of the approximation
  const at::Tensor x = at::linspace(-9, 9, kCount), exact = at::gelu(x.to(at::kDouble));
  at::Tensor got = at::empty_like(x);
  dense_kernels().activate_row(x.const_data_ptr<float>(), kCount, got.data_ptr<float>());
  const at::Tensor error = (got.to(at::kDouble) - exact).abs() / exact.abs().clamp_min(1);
  const bool by_ratio = std::string_view(cpu_isa()) == "baseline";
  EXPECT_LT(error.max().item<double>(), by_ratio ? 1e-6 : 1e-7);
  // Beyond the approximation's end nothing is left of the negative side, nor of the rounding.
  const std::vector<float> far = {-6.5f, -80, -1e30f, -std::numeric_limits<float>::infinity(),
                                  6.5f,  80,  1e30f,  std::numeric_limits<float>::infinity()};
  std::vector<float> out(far.size());
  dense_kernels().activate_row(far.data(), static_cast<int64_t>(far.size()), out.data());
  for (size_t i = 0; i < far.size(); ++i) EXPECT_EQ(out[i], i < 4 ? 0 : far[i]) << far[i];
}

/// Rows of whole blocks, of fewer, and of columns past a block, and nothing written beyond.
template <typename T, typename Transpose>
void expect_rows_become_columns(const Transpose& transpose) {
  for (const auto& [rows, columns] :
       {std::array<int64_t, 2>{16, 16}, {16, 48}, {3, 16}, {16, 5}, {7, 37}, {1, 1}}) {
    const int64_t stride = columns + 3, to_stride = kBlock + 5;
    std::vector<T> from(static_cast<size_t>(rows * stride));
    for (size_t i = 0; i < from.size(); ++i) from[i] = static_cast<T>(i + 1);
    std::vector<T> to(static_cast<size_t>((columns + 1) * to_stride), T{7777});
    transpose(TransposedRows<T>{from.data(), stride, rows, columns, to.data(), to_stride});
    for (int64_t c = 0; c <= columns; ++c) {
      for (int64_t r = 0; r < to_stride; ++r) {
        const T expected = c == columns || r >= kBlock ? T{7777}
                           : r >= rows                 ? T{}
                                                       : from[static_cast<size_t>(r * stride + c)];
        EXPECT_EQ(to[static_cast<size_t>(c * to_stride + r)], expected)
            << rows << " x " << columns << " at " << c << ", " << r;
      }
    }
  }
}

TEST(DenseKernels, RowsBecomeColumns) {
  expect_rows_become_columns<float>(
      [](const TransposedRows<float>& rows) { dense_kernels().transpose(rows, 1); });
  const float row[] = {1, 2, 3};
  float to[3 * kBlock] = {};
  dense_kernels().transpose({row, 3, 1, 3, to, kBlock}, 0.5f);
  for (int64_t c = 0; c < 3; ++c) EXPECT_EQ(to[c * kBlock], 0.5f * row[c]);
}

TEST(Bf16Kernels, RowsOfPairsBecomeColumns) {
  expect_rows_become_columns<uint32_t>(
      [](const TransposedRows<uint32_t>& rows) { bf16_kernels().transpose(rows); });
}

/// What bfloat16 reads next: a bfloat16 below 1 is rounded by up to 2 · 10^-3.
TEST(Bf16Kernels, GeluAndItsSlopeAreTheFormulasWithinARounding) {
  const int64_t rows = 97;
  const at::Tensor x = at::linspace(-12, 12, rows * kPanel).view({rows, kPanel}),
                   wide = x.to(at::kDouble).requires_grad_();
  at::gelu(wide).sum().backward();
  at::Tensor value = x.clone(), slope = at::empty_like(x), alone = x.clone();
  bf16_kernels().activate_with_slope(value.data_ptr<float>(), rows, kPanel / kBlock,
                                     slope.data_ptr<float>());
  bf16_kernels().activate(alone.data_ptr<float>(), rows, kPanel / kBlock);
  EXPECT_TRUE(value.equal(alone)) << "as without the slope";
  EXPECT_LT((value.to(at::kDouble) - at::gelu(wide)).abs().max().item<double>(), 2e-4);
  EXPECT_LT((slope.to(at::kDouble) - wide.grad()).abs().max().item<double>(), 3e-4);
}

TEST(DenseKernels, LayerNormIsItsFormulaInAnyWidth) {
  for (const int64_t C : {1, 5, 15, 16, 17, 33, 48, 127, 128, 129, 200, 256, 300}) {
    constexpr int64_t kRows = 7;
    const int64_t padded = (C + kBlock - 1) / kBlock * kBlock;
    const at::Tensor x = test::normal({kRows, C}, 1).mul(3).add(50).to(at::kFloat);
    const at::Tensor gain = test::normal({C}, 2, at::kFloat),
                     bias = test::normal({C}, 3, at::kFloat);
    const auto pad = [&](const at::Tensor& t) { return at::constant_pad_nd(t, {0, padded - C}); };
    const at::Tensor wide_gain = pad(gain), wide_bias = pad(bias);
    Rows tile(kRows, C, x, 0), out(kRows, C, at::zeros_like(x), -1);
    dense_kernels().layer_norm(tile.values.data(), kRows, tile.stride(), C,
                               wide_gain.const_data_ptr<float>(), wide_bias.const_data_ptr<float>(),
                               out.values.data());
    const at::Tensor exact = at::layer_norm(x.to(at::kDouble), {C}, gain.to(at::kDouble),
                                            bias.to(at::kDouble), double{kNormEpsilon});
    for (int64_t r = 0; r < kRows; ++r) {
      for (int64_t c = 0; c < C; ++c) {
        EXPECT_NEAR(out.at(r, c), exact[r][c].item<double>(), 2e-5) << C << ": " << r << ", " << c;
      }
      for (int64_t c = C; c < padded; ++c) EXPECT_EQ(out.at(r, c), 0) << "past the last of " << C;
    }
  }
}

TEST(DenseKernels, RaisesTwoToEachScoreAndAddsRowsUp) {
  for (const int64_t count : {1, 7, 8, 15, 16, 17, 40, 127, 128}) {
    constexpr int64_t kRows = 3;
    const at::Tensor x = test::uniform({kRows, count}, 4).mul(200).sub(100);
    Rows tile(kRows, count, x, 99);
    std::vector<float> sum(kRows * kBlock, 0.25f);
    dense_kernels().raise(tile.values.data(), kRows, count, sum.data());
    for (int64_t r = 0; r < kRows; ++r) {
      double expected = 0.25 * kBlock, total = 0;
      for (int64_t c = 0; c < count; ++c) {
        const double exact = std::exp2(x[r][c].item<double>());
        EXPECT_NEAR(tile.at(r, c) / exact, 1, 3e-7) << x[r][c].item<double>();
        expected += exact;
      }
      if (count < kPanel) {
        EXPECT_EQ(tile.at(r, count), 99) << "past the last";
      }
      for (int64_t lane = 0; lane < kBlock; ++lane) total += sum[r * kBlock + lane];
      EXPECT_NEAR(total / expected, 1, 1e-6) << count;
    }
  }
}

TEST(DenseKernels, TheSoftmaxOfAnyScoresIsThatOfBaseTwo) {
  for (const int64_t count : {1, 17, 128, 300}) {
    constexpr int64_t kRows = 2;
    const at::Tensor x = test::normal({kRows, count}, 5).mul(300).to(at::kFloat);
    Rows tile(kRows, count, x, 1e9f);
    std::vector<float> inverse(kRows), largest(kRows);
    dense_kernels().exponentiate(tile.values.data(), kRows, tile.stride(), count, inverse.data(),
                                 largest.data());
    const at::Tensor wide = x.to(at::kDouble) * std::log(2.0), exact = at::softmax(wide, 1);
    for (int64_t r = 0; r < kRows; ++r) {
      for (int64_t c = 0; c < count; ++c) {
        EXPECT_NEAR(tile.at(r, c) * inverse[r], exact[r][c].item<double>(), 1e-6);
      }
      EXPECT_EQ(largest[static_cast<size_t>(r)], x[r].max().item<float>());
    }
  }
}

TEST(DenseKernels, TheLongestRowIsFoundUnlessOneIsNotFinite) {
  for (const int64_t columns : {1, 5, 16, 17, 32, 100}) {
    const at::Tensor x = test::normal({9, columns}, 6, at::kFloat);
    const double exact = x.to(at::kDouble).square().sum(1).max().item<double>();
    const auto largest = [&](const at::Tensor& t) {
      return dense_kernels().largest_square(t.const_data_ptr<float>(), 9, columns, columns);
    };
    EXPECT_NEAR(largest(x) / exact, 1, 1e-6);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f}) {
      at::Tensor y = x.clone();
      y[4][columns - 1] = bad;
      EXPECT_TRUE(std::isnan(largest(y))) << bad;
    }
  }
}

}  // namespace
}  // namespace lte::ops
