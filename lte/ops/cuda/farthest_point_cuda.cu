// farthest_point_sampling on CUDA: a persistent block for each of many sets of points. Up to 32,768
// points their distances stay in registers, up to 8,192 the points too.
//
// Every pick waits for the one before, so a block takes six times as long as the host, which looks
// at few points a pick. Few sets are the host's.
#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <ATen/core/Tensor.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/full.h>
#include <c10/cuda/CUDAException.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/library.h>

#include "lte/ops/farthest_point.h"
#include "lte/ops/farthest_point_args.h"

namespace lte::ops {
namespace {

constexpr int kThreads = 1024, kWarp = 32;
static_assert(kThreads == kWarp * kWarp, "one warp reads what all warps have found");
/// Points whose distances the threads hold in registers, and those held with their positions.
constexpr int64_t kMaxInRegisters = 32 * kThreads, kMaxHeld = 8 * kThreads;
constexpr size_t kMaxSets = 16;  ///< of a launch, which has them among its arguments
/// Sets that the host works through in less time than a block takes for one.
constexpr size_t kHostSets = 4;

struct Set {
  const float* points;  ///< [N, 3]
  float* nearest;       ///< [N], +inf; nullptr where registers hold it
  int64_t* picks;       ///< [count]
  float* insertion;     ///< [count]
  int N, count;
};

struct Sets {
  Set set[kMaxSets];
};

/// Distances must not be contracted to fused multiply-adds: the CPU's are not, and ties depend on
/// the last bit.
__device__ __forceinline__ float squared_distance(float dx, float dy, float dz) {
  return __fadd_rn(__fadd_rn(__fmul_rn(dx, dx), __fmul_rn(dy, dy)), __fmul_rn(dz, dz));
}

/// A distance and its point such that the larger wins by `far`, then by `near_end`: non-negative
/// floats are in the order of their bits, and the lower index has the larger complement.
struct Candidate {
  unsigned far, near_end;
};

__device__ __forceinline__ Candidate candidate(float dist2, int index) {
  return {dist2 < 0 ? 0u : __float_as_uint(dist2) + 1u, ~static_cast<unsigned>(index)};
}

__device__ __forceinline__ Candidate best_of_warp(Candidate mine) {
  const unsigned far = __reduce_max_sync(0xffffffffu, mine.far);
  return {far, __reduce_max_sync(0xffffffffu, mine.far == far ? mine.near_end : 0u)};
}

/// The best of the block, to all of its threads. Calls that follow each other have different
/// `turn`: a warp that is ahead must not write what another still reads.
__device__ __forceinline__ Candidate best_of_block(Candidate mine, int turn) {
  __shared__ Candidate of_warps[2][kWarp];
  const Candidate of_warp = best_of_warp(mine);
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  if (lane == 0) of_warps[turn][warp] = of_warp;
  __syncthreads();
  return best_of_warp(of_warps[turn][lane]);
}

/// @return the index picked
__device__ __forceinline__ int note_pick(const Set& set, int pick, Candidate winner) {
  const int index = static_cast<int>(~winner.near_end);
  if (threadIdx.x == 0) {
    set.picks[pick] = index;
    set.insertion[pick] = __uint_as_float(winner.far - 1u);
  }
  return index;
}

__device__ __forceinline__ void note_first(const Set& set) {
  if (threadIdx.x != 0) return;
  set.picks[0] = 0;
  set.insertion[0] = INFINITY;
}

/// Each thread has the points i with i % kThreads = its number, kItems of them.
template <int kItems>
__global__ void __launch_bounds__(kThreads) sample_in_registers(const Sets sets) {
  constexpr bool kHolds = kItems * kThreads <= kMaxHeld;
  const Set& set = sets.set[blockIdx.x];
  const int thread = static_cast<int>(threadIdx.x);
  if (set.count == 0) return;
  float nearest[kItems], held[kHolds ? kItems : 1][3];
#pragma unroll
  for (int j = 0; j < kItems; ++j) {
    const int i = thread + j * kThreads;
    nearest[j] = i < set.N ? INFINITY : -1.0f;  // which no distance is below
    if constexpr (kHolds) {
#pragma unroll
      for (int axis = 0; axis < 3; ++axis) held[j][axis] = i < set.N ? set.points[3 * i + axis] : 0;
    }
  }
  note_first(set);
  int last = 0;
  for (int pick = 1; pick < set.count; ++pick) {
    const float x = set.points[3 * last], y = set.points[3 * last + 1],
                z = set.points[3 * last + 2];
    float farthest = -1;
    int at = 0;
#pragma unroll
    for (int j = 0; j < kItems; ++j) {
      const int i = thread + j * kThreads;
      const float* p = set.points + 3 * (i < set.N ? i : 0);
      if constexpr (kHolds) p = held[j];
      const float d = squared_distance(p[0] - x, p[1] - y, p[2] - z);
      // A pick stays out of the race even when all that is left coincides with picks.
      if (i == last) nearest[j] = -1;
      if (d < nearest[j]) nearest[j] = d;
      if (nearest[j] > farthest) {
        farthest = nearest[j];
        at = i;
      }
    }
    last = note_pick(set, pick, best_of_block(candidate(farthest, at), pick & 1));
  }
}

__global__ void __launch_bounds__(kThreads) sample_in_memory(const Sets sets) {
  const Set& set = sets.set[blockIdx.x];
  if (set.count == 0) return;
  note_first(set);
  int last = 0;
  for (int pick = 1; pick < set.count; ++pick) {
    const float x = set.points[3 * static_cast<int64_t>(last)],
                y = set.points[3 * static_cast<int64_t>(last) + 1],
                z = set.points[3 * static_cast<int64_t>(last) + 2];
    float farthest = -1;
    int at = 0;
    for (int i = static_cast<int>(threadIdx.x); i < set.N; i += kThreads) {
      const float* p = set.points + 3 * static_cast<int64_t>(i);
      const float d = squared_distance(p[0] - x, p[1] - y, p[2] - z);
      float& nearest = set.nearest[i];
      if (i == last) nearest = -1;
      if (d < nearest) nearest = d;
      if (nearest > farthest) {
        farthest = nearest;
        at = i;
      }
    }
    last = note_pick(set, pick, best_of_block(candidate(farthest, at), pick & 1));
  }
}

/// @param most  points of the largest set
void launch(const Sets& sets, size_t count, int64_t most) {
  const auto blocks = static_cast<unsigned>(count);
  const auto stream = c10::cuda::getCurrentCUDAStream();
  if (most <= kThreads) {
    sample_in_registers<1><<<blocks, kThreads, 0, stream>>>(sets);
  } else if (most <= 4 * kThreads) {
    sample_in_registers<4><<<blocks, kThreads, 0, stream>>>(sets);
  } else if (most <= 8 * kThreads) {
    sample_in_registers<8><<<blocks, kThreads, 0, stream>>>(sets);
  } else if (most <= 16 * kThreads) {
    sample_in_registers<16><<<blocks, kThreads, 0, stream>>>(sets);
  } else if (most <= kMaxInRegisters) {
    sample_in_registers<32><<<blocks, kThreads, 0, stream>>>(sets);
  } else {
    sample_in_memory<<<blocks, kThreads, 0, stream>>>(sets);
  }
  C10_CUDA_KERNEL_LAUNCH_CHECK();
}

std::tuple<std::vector<at::Tensor>, std::vector<at::Tensor>> on_the_host(at::TensorList sets,
                                                                         at::IntArrayRef counts) {
  std::vector<at::Tensor> host;
  for (const at::Tensor& points : sets) host.push_back(points.cpu());
  auto [picks, insertions] = farthest_point_sampling_of_sets(host, counts);
  for (std::vector<at::Tensor>* of : {&picks, &insertions}) {
    for (at::Tensor& t : *of) t = t.to(sets[0].device());
  }
  return {std::move(picks), std::move(insertions)};
}

std::tuple<std::vector<at::Tensor>, std::vector<at::Tensor>> farthest_point_sampling_of_sets_cuda(
    at::TensorList sets, at::IntArrayRef counts) {
  check_farthest_point_sets(sets, counts);
  std::vector<at::Tensor> picks, insertions, nearest;
  if (sets.empty()) return {picks, insertions};
  const c10::cuda::CUDAGuard guard(sets[0].device());
  if (sets.size() <= kHostSets) return on_the_host(sets, counts);
  int64_t most = 0;
  for (const at::Tensor& points : sets) most = std::max(most, points.size(0));
  for (size_t first = 0; first < sets.size(); first += kMaxSets) {
    const size_t count = std::min(kMaxSets, sets.size() - first);
    Sets arguments{};
    for (size_t i = 0; i < count; ++i) {
      const at::Tensor& points = sets[first + i];
      const int64_t of = counts[first + i];
      picks.push_back(at::empty({of}, points.options().dtype(at::kLong)));
      insertions.push_back(at::empty({of}, points.options()));
      const bool in_memory = most > kMaxInRegisters;
      if (in_memory) nearest.push_back(at::full({points.size(0)}, INFINITY, points.options()));
      arguments.set[i] = {
          points.const_data_ptr<float>(),   in_memory ? nearest.back().data_ptr<float>() : nullptr,
          picks.back().data_ptr<int64_t>(), insertions.back().data_ptr<float>(),
          static_cast<int>(points.size(0)), static_cast<int>(of)};
    }
    launch(arguments, count, most);
  }
  return {picks, insertions};
}

std::tuple<at::Tensor, at::Tensor> farthest_point_sampling_cuda(const at::Tensor& points,
                                                                int64_t count) {
  const auto [picks, insertions] = farthest_point_sampling_of_sets_cuda({points}, {count});
  return {picks[0], insertions[0]};
}

}  // namespace

TORCH_LIBRARY_IMPL(lte, CUDA, m) {
  m.impl("farthest_point_sampling", farthest_point_sampling_cuda);
  m.impl("farthest_point_sampling_of_sets", farthest_point_sampling_of_sets_cuda);
}

}  // namespace lte::ops
