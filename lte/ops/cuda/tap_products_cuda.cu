// A block of 256 threads makes 64 x 64 numbers of a product, 16 terms at a time by way of shared
// memory; a thread has 4 x 4 of them in registers.
#include <algorithm>

#include <ATen/ops/empty.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAStream.h>

#include "lte/ops/cuda/tap_products.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 256, kEdge = 64, kDepth = 16, kEach = 4;
/// Pairs whose outer products a block adds up; a tap may have several hundred times as many.
constexpr int kRun = 1024;
static_assert(kThreads * kEach * kEach == kEdge * kEdge);

/// The taps' pairs in runs of at most `length`, for blocks to find what is theirs.
struct Taps {
  int count, length;
  int begin[kMaxTaps + 1];  ///< first pairs
  int run[kMaxTaps + 1];    ///< first runs
};

Taps taps_of(const at::Tensor& tap_begin, int length) {
  Taps taps{};
  const auto* begin = tap_begin.const_data_ptr<int64_t>();
  taps.count = static_cast<int>(tap_begin.size(0) - 1);
  taps.length = length;
  for (int tap = 0; tap <= taps.count; ++tap) {
    taps.begin[tap] = static_cast<int>(begin[tap]);
    if (tap > 0)
      taps.run[tap] =
          taps.run[tap - 1] + (taps.begin[tap] - taps.begin[tap - 1] + length - 1) / length;
  }
  return taps;
}

struct Run {
  int tap, first, end;  ///< pairs [first, end)
};

__device__ Run find_run(const Taps& taps, int at) {
  int low = 0, high = taps.count;  // the first run of `low` is at most `at`, of `high` past it
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (taps.run[middle] <= at ? low : high) = middle;
  }
  const int first = taps.begin[low] + (at - taps.run[low]) * taps.length;
  return {low, first, min(first + taps.length, taps.begin[low + 1])};
}

/// kDepth terms of each of kEdge rows, and of each of kEdge columns, term by term.
struct Tile {
  float left[kDepth][kEdge + 4], right[kDepth][kEdge];
};

/// Adds up the kDepth terms in shared memory for this thread's numbers.
__device__ __forceinline__ void add_terms(const Tile& tile, float (&sum)[kEach][kEach]) {
  const int row = static_cast<int>(threadIdx.x) / 16 * kEach,
            column = static_cast<int>(threadIdx.x) % 16 * kEach;
#pragma unroll
  for (int term = 0; term < kDepth; ++term) {
    float left[kEach], right[kEach];
#pragma unroll
    for (int i = 0; i < kEach; ++i) {
      left[i] = tile.left[term][row + i];
      right[i] = tile.right[term][column + i];
    }
#pragma unroll
    for (int i = 0; i < kEach; ++i) {
#pragma unroll
      for (int j = 0; j < kEach; ++j) sum[i][j] = fmaf(left[i], right[j], sum[i][j]);
    }
  }
}

/// Writes this thread's numbers to `out` of row stride `stride`, as far as there are rows and
/// columns.
__device__ __forceinline__ void store(const float (&sum)[kEach][kEach], float* out, int64_t stride,
                                      int rows, int columns) {
  const int row = static_cast<int>(threadIdx.x) / 16 * kEach,
            column = static_cast<int>(threadIdx.x) % 16 * kEach;
#pragma unroll
  for (int i = 0; i < kEach; ++i) {
#pragma unroll
    for (int j = 0; j < kEach; ++j) {
      if (row + i < rows && column + j < columns) out[(row + i) * stride + column + j] = sum[i][j];
    }
  }
}

/// Blocks: (run of at most kEdge pairs of one tap, run of columns).
template <bool kTransposed>
__global__ void __launch_bounds__(kThreads)
    product_kernel(const Taps taps, const float* rows, int N, const int* row, const float* weight,
                   float* out, int A, int B) {
  __shared__ Tile tile;
  __shared__ int of_tile[kEdge];
  const Run run = find_run(taps, static_cast<int>(blockIdx.x));
  const int thread = static_cast<int>(threadIdx.x), count = run.end - run.first,
            column0 = static_cast<int>(blockIdx.y) * kEdge;
  const float* w = weight + static_cast<int64_t>(run.tap) * A * B;
  if (thread < kEdge) {
    of_tile[thread] = thread < count ? row[run.first + thread] : -1;
    CUDA_KERNEL_ASSERT(of_tile[thread] < N && "a pair outside the input");
  }
  float sum[kEach][kEach] = {};
  for (int term0 = 0; term0 < A; term0 += kDepth) {
    __syncthreads();  // the rows are known, and the terms before no longer read
    for (int i = thread; i < kEdge * kDepth; i += kThreads) {
      const int r = i / kDepth, term = i % kDepth;
      tile.left[term][r] = of_tile[r] >= 0 && term0 + term < A
                               ? rows[static_cast<int64_t>(of_tile[r]) * A + term0 + term]
                               : 0;
      // Threads that follow each other read what lies side by side in the weights.
      const int t = kTransposed ? i % kDepth : i / kEdge, c = kTransposed ? i / kDepth : i % kEdge;
      const bool inside = term0 + t < A && column0 + c < B;
      const int64_t place = kTransposed ? static_cast<int64_t>(column0 + c) * A + term0 + t
                                        : static_cast<int64_t>(term0 + t) * B + column0 + c;
      tile.right[t][c] = inside ? w[place] : 0;
    }
    __syncthreads();
    add_terms(tile, sum);
  }
  store(sum, out + static_cast<int64_t>(run.first) * B + column0, B, count, B - column0);
}

/// Blocks: (run of pairs of one tap, run of rows, run of columns).
__global__ void __launch_bounds__(kThreads)
    outer_kernel(const Taps taps, const float* left, const int* left_row, const float* right,
                 const int* right_row, float* out, int A, int B) {
  __shared__ Tile tile;
  const Run run = find_run(taps, static_cast<int>(blockIdx.x));
  const int thread = static_cast<int>(threadIdx.x), end = run.end,
            row0 = static_cast<int>(blockIdx.y) * kEdge,
            column0 = static_cast<int>(blockIdx.z) * kEdge;
  float sum[kEach][kEach] = {};
  for (int pair0 = run.first; pair0 < end; pair0 += kDepth) {
    __syncthreads();  // the terms before are no longer read
    for (int i = thread; i < kEdge * kDepth; i += kThreads) {
      const int term = i / kEdge, c = i % kEdge, pair = pair0 + term;
      tile.left[term][c] = pair < end && row0 + c < A
                               ? left[static_cast<int64_t>(left_row[pair]) * A + row0 + c]
                               : 0;
      tile.right[term][c] = pair < end && column0 + c < B
                                ? right[static_cast<int64_t>(right_row[pair]) * B + column0 + c]
                                : 0;
    }
    __syncthreads();
    add_terms(tile, sum);
  }
  store(sum, out + (static_cast<int64_t>(blockIdx.x) * A + row0) * B + column0, B, A - row0,
        B - column0);
}

/// out[tap] = the sum of its runs' [numbers], in their order.
__global__ void __launch_bounds__(kThreads)
    sum_of_runs_kernel(const Taps taps, const float* of_runs, float* out, int64_t numbers) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kThreads + threadIdx.x;
  if (i >= taps.count * numbers) return;
  const int64_t tap = i / numbers, number = i % numbers;
  float sum = 0;
  for (int run = taps.run[tap]; run < taps.run[tap + 1]; ++run)
    sum += of_runs[run * numbers + number];
  out[i] = sum;
}

unsigned blocks_of(int64_t numbers, int each) {
  return static_cast<unsigned>((numbers + each - 1) / each);
}

}  // namespace

at::Tensor products_by_tap(const at::Tensor& rows, const at::Tensor& row, const at::Tensor& weight,
                           const at::Tensor& tap_begin, bool transposed) {
  const int64_t A = rows.size(1), B = weight.size(transposed ? 1 : 2);
  at::Tensor out = at::empty({row.size(0), B}, rows.options());
  const Taps taps = taps_of(tap_begin, kEdge);
  const auto runs = static_cast<unsigned>(taps.run[taps.count]);
  if (runs == 0 || B == 0) return out;
  const auto kernel = transposed ? product_kernel<true> : product_kernel<false>;
  kernel<<<dim3(runs, blocks_of(B, kEdge)), kThreads, 0, c10::cuda::getCurrentCUDAStream()>>>(
      taps, rows.const_data_ptr<float>(), static_cast<int>(rows.size(0)), row.const_data_ptr<int>(),
      weight.const_data_ptr<float>(), out.data_ptr<float>(), static_cast<int>(A),
      static_cast<int>(B));
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return out;
}

at::Tensor outer_products_by_tap(const at::Tensor& left, const at::Tensor& left_row,
                                 const at::Tensor& right, const at::Tensor& right_row,
                                 const at::Tensor& tap_begin) {
  const int64_t A = left.size(1), B = right.size(1);
  const Taps taps = taps_of(tap_begin, kRun);
  at::Tensor out = at::empty({taps.count, A, B}, left.options());
  if (out.numel() == 0) return out;
  const int runs = taps.run[taps.count];
  const at::Tensor of_runs = at::empty({runs, A, B}, left.options());
  const auto stream = c10::cuda::getCurrentCUDAStream();
  if (runs > 0) {
    const dim3 blocks(static_cast<unsigned>(runs), blocks_of(A, kEdge), blocks_of(B, kEdge));
    outer_kernel<<<blocks, kThreads, 0, stream>>>(
        taps, left.const_data_ptr<float>(), left_row.const_data_ptr<int>(),
        right.const_data_ptr<float>(), right_row.const_data_ptr<int>(), of_runs.data_ptr<float>(),
        static_cast<int>(A), static_cast<int>(B));
    C10_CUDA_KERNEL_LAUNCH_CHECK();
  }
  sum_of_runs_kernel<<<blocks_of(out.numel(), kThreads), kThreads, 0, stream>>>(
      taps, of_runs.const_data_ptr<float>(), out.data_ptr<float>(), A * B);
  C10_CUDA_KERNEL_LAUNCH_CHECK();
  return out;
}

}  // namespace lte::ops
