// An order of points along the Z curve, on the CPU.
#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/ops/cpu/search/radix_sort.h"
#include "lte/ops/curve_codes_kernel.h"
#include "lte/ops/spatial_order_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int32_t kCells = 1024;  ///< an axis: three times ten bits fit the key

at::Tensor spatial_order_cpu(const at::Tensor& points) {
  check_spatial_order_args(points);
  const int64_t N = points.size(0);
  const auto* p = points.const_data_ptr<float>();
  float low[3], extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    float least = INFINITY, most = -INFINITY;
    for (int64_t i = axis; i < 3 * N; i += 3) {
      least = std::min(least, p[i]);
      most = std::max(most, p[i]);
    }
    low[axis] = least;
    extent = std::max(extent, most - least);
  }
  const float cells_per_unit = static_cast<float>(kCells) / extent;
  std::vector<uint32_t> key(N);
  at::parallel_for(0, N, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      int32_t cell[3];
      for (int axis = 0; axis < 3; ++axis) {
        const float at = (p[3 * i + axis] - low[axis]) * cells_per_unit;
        // NaN where all points coincide or their extent overflows.
        cell[axis] = at >= 0 ? static_cast<int32_t>(std::min(at, kCells - 1.0f)) : 0;
      }
      key[i] = static_cast<uint32_t>(z_code(cell[0], cell[1], cell[2]));
    }
  });
  const std::vector<int32_t> order = sort_rows(key);
  at::Tensor out = at::empty({N}, points.options().dtype(at::kLong));
  std::copy(order.begin(), order.end(), out.data_ptr<int64_t>());
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("spatial_order", lte::ops::spatial_order_cpu); }
