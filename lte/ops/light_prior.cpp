#include "lte/ops/light_prior.h"

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/light_prior_args.h"
#include "lte/tensor/functions.h"

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

at::Tensor light_prior_features(const at::Tensor& any_means, const PriorScales& scales) {
  const char* op = "light_prior_features";
  TORCH_CHECK(any_means.dim() == 2 &&
                  (any_means.size(1) == kPriorMeans || any_means.size(1) == kPriorMeans + 1),
              op, ": means must be [Q, ", kPriorMeans, " or one more], got ", any_means.sizes());
  check_columns(any_means, any_means.size(0), any_means.size(1), op, "means");
  const at::Tensor means = any_means.contiguous();
  const int64_t columns = means.size(1);
  at::Tensor out = at::empty(means.sizes(), means.options());
  at::parallel_for(0, means.size(0), 16 * kQueries, [&](int64_t begin, int64_t end) {
    prior_kernels().features(means.const_data_ptr<float>() + columns * begin, end - begin, columns,
                             scales, out.data_ptr<float>() + columns * begin);
  });
  return out;
}

}  // namespace lte::ops
