#include "lte/ops/light_prior.h"

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/light_prior_args.h"

namespace lte::ops {
namespace {

constexpr int64_t kQueries = 64;  ///< that one thread takes at least

}  // namespace

at::Tensor light_prior_means(const at::Tensor& position, const at::Tensor& normal,
                             const at::Tensor& points, const at::Tensor& normals,
                             const at::Tensor& light, const at::Tensor& errors,
                             const at::Tensor& index, const PriorWeights& weights) {
  check_light_prior_args(position, normal, points, normals, light, errors, index);
  const at::Tensor p = position.contiguous(), n = normal.contiguous(), from = points.contiguous(),
                   facing = normals.contiguous(), values = light.contiguous(),
                   spread = errors.defined() ? errors.contiguous() : errors,
                   near = index.contiguous();
  const int64_t Q = near.size(0), K = near.size(1);
  const int64_t columns = kPriorMeans + (spread.defined() ? 1 : 0);
  at::Tensor out = at::empty({Q, columns}, p.options());
  const PriorPoints known{from.const_data_ptr<float>(), facing.const_data_ptr<float>(),
                          values.const_data_ptr<float>(),
                          spread.defined() ? spread.const_data_ptr<float>() : nullptr};
  at::parallel_for(0, Q, kQueries, [&](int64_t begin, int64_t end) {
    const PriorQueries queries{p.const_data_ptr<float>() + 3 * begin,
                               n.const_data_ptr<float>() + 3 * begin,
                               near.const_data_ptr<int64_t>() + begin * K, end - begin, K};
    prior_kernels().means(known, queries, weights, out.data_ptr<float>() + columns * begin);
  });
  return out;
}

}  // namespace lte::ops
