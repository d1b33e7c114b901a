#include "lte/nn/encoder/pooling.h"

#include <limits>

#include "lte/ops/gelu.h"
#include "lte/tensor/functions.h"

namespace lte::nn {

at::Tensor cluster_max(const at::Tensor& x, const at::Tensor& cluster, int64_t clusters) {
  const at::Tensor target = cluster.unsqueeze(1).expand_as(x);
  const double lowest = -std::numeric_limits<double>::infinity();
  return at::full({clusters, x.size(1)}, lowest, x.options()).scatter_reduce(0, target, x, "amax");
}

at::Tensor cluster_argmax(const at::Tensor& x, const at::Tensor& cluster, int64_t clusters) {
  const at::NoGradGuard no_grad;
  const int64_t n = x.size(0), C = x.size(1);
  const at::Tensor target = cluster.unsqueeze(1).expand({n, C});
  const at::Tensor top = cluster_max(x, cluster, clusters);
  // A NaN is no maximum's equal, but it stays: the maximum of its cluster is NaN, and it alone is
  // not passed over.
  const at::Tensor below = x.ne(top.index_select(0, cluster)).logical_and(x.eq(x));
  const at::Tensor row = at::arange(n, cluster.options()).unsqueeze(1).expand({n, C});
  return at::full({clusters, C}, n, cluster.options())
      .scatter_reduce(0, target, row.masked_fill(below, n), "amin");
}

PoolingImpl::PoolingImpl(int64_t inputs, int64_t outputs, bool centers)
    : linear_(register_module("linear", Linear(inputs, outputs))),
      norm_(register_module("norm", PointNorm(outputs, centers))) {}

at::Tensor PoolingImpl::forward(const at::Tensor& fine, const StagePlan& stage) {
  const at::Tensor x = linear_->forward(fine);
  if (!at::GradMode::is_enabled()) {
    return ops::gelu(norm_->forward(cluster_max(x, stage.cluster, stage.points()), stage));
  }
  // A gather: each gradient goes to one row, and no two to the same, so the sum needs no order.
  const at::Tensor pooled = x.gather(0, cluster_argmax(x, stage.cluster, stage.points()));
  return ops::gelu(norm_->forward(pooled, stage));
}

UnpoolingImpl::UnpoolingImpl(int64_t coarse, int64_t skip, int64_t outputs, bool centers)
    : coarse_(register_module("coarse", Linear(coarse, outputs))),
      skip_(register_module("skip", Linear(skip, outputs))),
      coarse_norm_(register_module("coarse_norm", PointNorm(outputs, centers))),
      skip_norm_(register_module("skip_norm", PointNorm(outputs, centers))) {}

at::Tensor UnpoolingImpl::forward(const at::Tensor& coarse, const at::Tensor& skip,
                                  const StagePlan& below, const StagePlan& stage) {
  const at::Tensor up = ops::gelu(coarse_norm_->after(coarse_, coarse, below));
  const at::Tensor across = ops::gelu(skip_norm_->after(skip_, skip, stage));
  return up.index_select(0, below.cluster) + across;
}

}  // namespace lte::nn
