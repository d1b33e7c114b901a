// convolution_pairs on CUDA: a binary search of every cell, shifted by every tap, in the
// sorted cells. The host waits for the number of pairs of each tap alone.
#include <algorithm>
#include <tuple>
#include <vector>

#include <ATen/ATen.h>
#include <c10/cuda/CUDAGuard.h>
#include <torch/library.h>

#include "lte/ops/submanifold_conv_args.h"

namespace lte::ops {
namespace {

/// Room for a shift past either end without a carry.
constexpr int64_t kFieldBits = kConvolutionCellBits + 1;
constexpr int64_t kField = int64_t{1} << kFieldBits;
/// Cells that are looked up at a time: 128 MiB of each of a few arrays.
constexpr int64_t kLookUps = int64_t{1} << 24;

/// [N] int64, in the order of the cells.
at::Tensor packed(const at::Tensor& cells, int64_t half) {
  const at::Tensor wide = cells.to(at::kLong).add(half);
  return wide.select(1, 0).mul(kField).add(wide.select(1, 1)).mul(kField).add(wide.select(1, 2));
}

/// Key distances of all taps, [taps] on the device of `like`.
at::Tensor tap_shifts(int64_t kernel, const at::Tensor& like) {
  std::vector<int64_t> shifts;
  const int64_t half = kernel / 2;
  for (int64_t dx = -half; dx <= half; ++dx) {
    for (int64_t dy = -half; dy <= half; ++dy) {
      for (int64_t dz = -half; dz <= half; ++dz) shifts.push_back((dx * kField + dy) * kField + dz);
    }
  }
  return at::tensor(shifts, at::kLong).to(like.device());
}

std::tuple<at::Tensor, at::Tensor> convolution_pairs_cuda(const at::Tensor& cells, int64_t kernel) {
  check_convolution_pairs_args(cells, kernel);
  const c10::cuda::CUDAGuard guard(cells.device());
  const int64_t N = cells.size(0), taps = kernel * kernel * kernel, centre = taps / 2;
  at::Tensor tap_begin = at::zeros({taps + 1}, at::kLong);
  if (N == 0) return {at::empty({2, 0}, cells.options()), tap_begin};
  // The host's check names the row.
  if (cells.bitwise_right_shift(kConvolutionCellBits).ne(0).any().item<bool>())
    check_convolution_pairs_args(cells.cpu(), kernel);

  const at::Tensor key = packed(cells, kernel / 2), shifts = tap_shifts(kernel, cells);
  // Stable: the first of a run of equal cells is their lowest row.
  const auto [sorted, order] = at::sort(key, /*stable=*/true, /*dim=*/0, /*descending=*/false);
  const int64_t together = std::clamp<int64_t>(kLookUps / N, 1, taps);
  std::vector<at::Tensor> outputs, inputs, counts;
  for (int64_t first = 0; first < taps; first += together) {
    const int64_t count = std::min(together, taps - first);
    const at::Tensor wanted = key.unsqueeze(0) + shifts.narrow(0, first, count).unsqueeze(1);
    const at::Tensor place = at::searchsorted(sorted, wanted).clamp_max_(N - 1);
    const at::Tensor found = at::take(sorted, place).eq(wanted);
    at::Tensor input = at::take(order, place);
    if (first <= centre && centre < first + count)
      input.select(0, centre - first).copy_(at::arange(N, order.options()));
    counts.push_back(found.sum(1));
    outputs.push_back(found.nonzero().select(1, 1));
    inputs.push_back(input.masked_select(found));
  }
  tap_begin.narrow(0, 1, taps).copy_(at::cat(counts).cumsum(0));
  return {at::stack({at::cat(outputs), at::cat(inputs)}).to(at::kInt).contiguous(), tap_begin};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) { m.impl("convolution_pairs", convolution_pairs_cuda); }

}  // namespace lte::ops
