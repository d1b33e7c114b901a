#include "lte/ops/cpu/dense/weight_gradient.h"

#include <algorithm>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/linear_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

void pair_up(const GradientRows& from, int64_t first, int64_t rows, int64_t column, int64_t columns,
             uint32_t* out) {
  for (int64_t i = 0; i < rows; i += 2, out += kPanel) {
    const int64_t even = from.row(first + i) * from.C + column;
    const bool paired = i + 1 < rows;
    const int64_t odd = paired ? from.row(first + i + 1) * from.C + column : 0;
    if (from.single != nullptr) {
      bf16_kernels().pair_rows(from.single + even, paired ? from.single + odd : nullptr, columns,
                               out);
    } else {
      pair_halves(from.half + even, paired ? from.half + odd : nullptr, columns, out);
    }
  }
}

/// Rows whose products are summed by themselves, so that threads can share the rows of a layer. The
/// parts are the same for any number of threads.
constexpr int64_t kPartRows = 8192;

at::Tensor weight_gradient_cpu(const at::Tensor& grad, const at::Tensor& x) {
  check_weight_gradient_args(grad, x);
  const bool bf16 = x.scalar_type() == at::kBFloat16;
  const int64_t N = x.size(0), O = grad.size(1), C = x.size(1);
  const int64_t parts = std::max<int64_t>(1, (N + kPartRows - 1) / kPartRows);
  const int64_t across = panels_of(C), tiles = panels_of(O) * across;
  at::Tensor sums = at::zeros({parts, O, C}, grad.options());
  const GradientRows left{grad.const_data_ptr<float>(), nullptr, O},
      right{bf16 ? nullptr : x.const_data_ptr<float>(),
            bf16 ? x.const_data_ptr<at::BFloat16>() : nullptr, C};
  auto* to = sums.data_ptr<float>();
  at::parallel_for(0, parts * tiles, 1, [&](int64_t begin, int64_t end) {
    WeightGradient gradient(bf16);
    for (int64_t i = begin; i < end; ++i) {
      const int64_t part = i / tiles, tile = i % tiles;
      gradient.add(left, tile / across, right, tile % across, part * kPartRows,
                   std::min(N, (part + 1) * kPartRows), to + part * O * C);
    }
  });
  at::Tensor out = sums[0];
  for (int64_t part = 1; part < parts; ++part) out.add_(sums[part]);
  return parts == 1 ? out : out.clone();
}

}  // namespace

void WeightGradient::Factor::take(const GradientRows& from, int64_t first, int64_t rows,
                                  int64_t column, int64_t columns) {
  if (!pairs.empty()) {
    pair_up(from, first, rows, column, columns, pairs.data());
    return;
  }
  for (int64_t i = 0; i < rows; ++i) {
    copy_row(from.single + from.row(first + i) * from.C + column, columns,
             single.data() + i * kPanel);
  }
}

void WeightGradient::add(const GradientRows& left, int64_t left_panel, const GradientRows& right,
                         int64_t right_panel, int64_t begin, int64_t end, float* out) {
  if (begin == end) return;
  const int64_t l = left_panel * kPanel, r = right_panel * kPanel;
  const int64_t rows = std::min(kPanel, left.C - l), columns = std::min(kPanel, right.C - r);
  for (int64_t i = begin; i < end; i += kRows) {
    const int64_t count = std::min(kRows, end - i);
    left_.take(left, i, count, l, rows);
    right_.take(right, i, count, r, columns);
    if (bf16_) {
      bf16_kernels().multiply_transposed(left_.pairs.data(), rows, (count + 1) / 2,
                                         right_.pairs.data(), blocks_of(columns), i > begin,
                                         product_.data());
    } else {
      gradient_kernels().multiply_transposed({left_.single.data(), rows, count,
                                              right_.single.data(), kPanel, kBlock, nullptr,
                                              blocks_of(columns), i > begin, product_.data()});
    }
  }
  for (int64_t row = 0; row < rows; ++row) {
    dense_kernels().accumulate(product_.data() + row * kPanel, columns,
                               out + (l + row) * right.C + r);
  }
}

}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("weight_gradient", lte::ops::weight_gradient_cpu); }
