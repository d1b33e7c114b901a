// The neighbour map of a submanifold convolution on the CPU: one merge of sorted cells with
// themselves, shifted, a tap.
#include <algorithm>
#include <numeric>
#include <vector>

#include "lte/ops/submanifold_conv_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

/// Room for a shift past either end without a carry.
constexpr int64_t kFieldBits = kConvolutionCellBits + 1;

/// Distinct cells in ascending order of key.
struct SortedCells {
  std::vector<int64_t> key;
  std::vector<int32_t> first;  ///< the lowest row of each
  std::vector<int32_t> slot;   ///< for every row: where its cell is in `key`

  SortedCells(const int32_t* cells, int64_t N, int64_t half) : slot(N) {
    std::vector<int64_t> keys(N);
    for (int64_t i = 0; i < N; ++i) keys[i] = pack(cells + 3 * i, half);
    std::vector<int32_t> order(N);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int32_t a, int32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
    for (const int32_t row : order) {
      if (key.empty() || key.back() != keys[row]) {
        key.push_back(keys[row]);
        first.push_back(row);
      }
      slot[row] = static_cast<int32_t>(key.size()) - 1;
    }
  }

  static int64_t pack(const int32_t* cell, int64_t half) {
    return (((cell[0] + half) << kFieldBits | (cell[1] + half)) << kFieldBits) | (cell[2] + half);
  }
};

/// Input row of every distinct cell for the tap at key distance `shift`, or -1. Adding a constant
/// keeps the order.
void match(const SortedCells& cells, int64_t shift, std::vector<int32_t>& input) {
  const auto n = static_cast<int64_t>(cells.key.size());
  int64_t other = 0;
  for (int64_t i = 0; i < n; ++i) {
    const int64_t wanted = cells.key[i] + shift;
    while (other < n && cells.key[other] < wanted) ++other;
    input[i] = other < n && cells.key[other] == wanted ? cells.first[other] : -1;
  }
}

std::tuple<at::Tensor, at::Tensor> convolution_pairs_cpu(const at::Tensor& cells, int64_t kernel) {
  check_convolution_pairs_args(cells, kernel);
  const int64_t N = cells.size(0), half = kernel / 2, taps = kernel * kernel * kernel;
  const auto* in = cells.const_data_ptr<int32_t>();

  const SortedCells sorted(in, N, half);
  std::vector<std::vector<int32_t>> outputs(taps), inputs(taps);
  at::parallel_for(0, taps, 1, [&](int64_t begin, int64_t end) {
    std::vector<int32_t> input(sorted.key.size());
    for (int64_t tap = begin; tap < end; ++tap) {
      const int64_t dx = tap / (kernel * kernel) - half, dy = tap / kernel % kernel - half,
                    dz = tap % kernel - half;
      const int64_t shift =
          ((dx * (int64_t{1} << kFieldBits)) + dy) * (int64_t{1} << kFieldBits) + dz;
      if (shift != 0) match(sorted, shift, input);
      for (int32_t row = 0; row < N; ++row) {
        const int32_t from = shift == 0 ? row : input[sorted.slot[row]];
        if (from < 0) continue;
        outputs[tap].push_back(row);
        inputs[tap].push_back(from);
      }
    }
  });

  at::Tensor tap_begin = at::empty({taps + 1}, cells.options().dtype(at::kLong));
  auto* start = tap_begin.data_ptr<int64_t>();
  start[0] = 0;
  for (int64_t tap = 0; tap < taps; ++tap) {
    start[tap + 1] = start[tap] + static_cast<int64_t>(outputs[tap].size());
  }
  at::Tensor pairs = at::empty({2, start[taps]}, cells.options());
  auto* out = pairs.data_ptr<int32_t>();
  for (int64_t tap = 0; tap < taps; ++tap) {
    std::copy(outputs[tap].begin(), outputs[tap].end(), out + start[tap]);
    std::copy(inputs[tap].begin(), inputs[tap].end(), out + start[taps] + start[tap]);
  }
  return {pairs, tap_begin};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("convolution_pairs", lte::ops::convolution_pairs_cpu); }
