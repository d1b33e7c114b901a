#include "lte/ops/irradiance_cache.h"

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>

#include "lte/ops/arguments.h"
#include "lte/ops/cpu/kernels/kernels.h"

namespace lte::ops {
namespace {

constexpr const char* kOp = "irradiance_cache_means";
constexpr int64_t kQueries = 64;  ///< that one thread takes at least

void check_columns(const at::Tensor& t, int64_t rows, int64_t columns, const char* name) {
  TORCH_CHECK(t.device().is_cpu() && t.scalar_type() == at::kFloat && t.dim() == 2 &&
                  t.size(0) == rows && t.size(1) == columns,
              kOp, ": ", name, " must be [", rows, ", ", columns, "] float32 on the CPU, got ",
              t.sizes(), " ", t.scalar_type(), " on ", t.device());
}

}  // namespace

at::Tensor irradiance_cache_means(const at::Tensor& position, const at::Tensor& normal,
                                  const at::Tensor& points, const at::Tensor& normals,
                                  const at::Tensor& light, const at::Tensor& index,
                                  const CacheWeights& weights) {
  TORCH_CHECK(position.dim() == 2 && points.dim() == 2, kOp,
              ": position and points must be [., 3], got ", position.sizes(), " and ",
              points.sizes());
  const int64_t Q = position.size(0), S = points.size(0);
  check_columns(position, Q, 3, "position");
  check_columns(normal, Q, 3, "normal");
  check_columns(points, S, 3, "points");
  check_columns(normals, S, 3, "normals");
  check_columns(light, S, 6, "light");
  const at::Tensor near = index.contiguous();
  check_neighbours(near, Q, S, kOp);
  const int64_t K = near.size(1);
  TORCH_CHECK(K >= 1 && K <= CacheKernels::kMostNeighbours, kOp, ": 1 to ",
              CacheKernels::kMostNeighbours, " neighbours, got ", K);
  const at::Tensor p = position.contiguous(), n = normal.contiguous(), from = points.contiguous(),
                   facing = normals.contiguous(), values = light.contiguous();
  at::Tensor out = at::empty({Q, kCacheMeans}, p.options());
  at::parallel_for(0, Q, kQueries, [&](int64_t begin, int64_t end) {
    cache_kernels().means(
        from.const_data_ptr<float>(), facing.const_data_ptr<float>(),
        values.const_data_ptr<float>(), near.const_data_ptr<int64_t>() + begin * K, end - begin, K,
        p.const_data_ptr<float>() + 3 * begin, n.const_data_ptr<float>() + 3 * begin, weights,
        out.data_ptr<float>() + kCacheMeans * begin);
  });
  return out;
}

}  // namespace lte::ops
