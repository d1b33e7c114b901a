// The order in which queries are decoded: queries near each other read the same latents, which they
// find in the cache when they follow each other.
#pragma once

#include "lte/nn/points/point_set.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// On the CPU along ops::spatial_order, on a GPU as they are.
class QueryOrder {
 public:
  /// @param position  [Q, 3], finite
  explicit QueryOrder(const at::Tensor& position);

  /// Rows of the queries, [Q, ...], in this order.
  at::Tensor ordered(const at::Tensor& rows) const;
  QuerySet ordered(const QuerySet& queries) const;
  /// Rows in this order, such as answers, as the queries are; differentiable.
  at::Tensor restored(const at::Tensor& rows) const;

 private:
  at::Tensor order_;  ///< [Q] int64; undefined: as they are
};

/// Queries begin to begin + count.
QuerySet block_of(const QuerySet& queries, int64_t begin, int64_t count);

}  // namespace lte::nn
