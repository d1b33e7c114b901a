// Rays among discs on the CPU: the walk of surfel_walk.h, a cell's discs tested many at once.
#include <algorithm>
#include <cmath>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/surfel_rays_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kRays = 256;  ///< that one thread takes at least

/// PlainCells with the discs in the lanes.
struct LaneCells {
  void test(const SurfelView& grid, int32_t begin, int32_t end, const SurfelRay& ray, float near,
            float far, Meetings& met) const {
    SurfelTests tests;
    for (int32_t k = begin; k < end; k += kMaxSurfels) {
      const int64_t count = std::min<int64_t>(end - k, kMaxSurfels);
      const SurfelProbe probe{grid.geometry + k,
                              grid.stride,
                              count,
                              {ray.origin.x, ray.origin.y, ray.origin.z},
                              {ray.direction.x, ray.direction.y, ray.direction.z},
                              near,
                              far,
                              met.limit};
      for (uint64_t found = surfel_kernels().test(probe, &tests); found != 0; found &= found - 1) {
        const int i = __builtin_ctzll(found);
        met.add(tests.distance[i], tests.square[i],
                std::abs(grid.geometry[6 * grid.stride + k + i]), grid.member[k + i],
                tests.toward[i] < 0);
      }
    }
  }
};

at::Tensor see_surfels_cpu(const at::Tensor& any_position, const at::Tensor& any_directions,
                           const at::Tensor& discs, const at::Tensor& geometry,
                           const at::Tensor& first, const at::Tensor& member,
                           at::ArrayRef<double> numbers, at::IntArrayRef size) {
  const at::Tensor position = any_position.contiguous(), directions = any_directions.contiguous();
  const SurfelGrid grid = grid_of(discs, geometry, first, member, numbers, size);
  check_see_surfels_args(position, directions, grid);
  const int64_t Q = directions.size(0), N = directions.size(1);
  at::Tensor out = at::empty({Q, N, kSeenColumns}, position.options());
  const SurfelView view = view_of(grid);
  const auto *from = position.const_data_ptr<float>(), *along = directions.const_data_ptr<float>();
  auto* seen = out.data_ptr<float>();
  at::parallel_for(0, Q * N, kRays, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      see(view, LaneCells(), {triple_at(from + i / N * 3), triple_at(along + 3 * i)},
          seen + i * kSeenColumns);
    }
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("see_surfels", lte::ops::see_surfels_cpu); }
