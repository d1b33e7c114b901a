#include "lte/nn/decoder/query_order.h"

#include "lte/ops/spatial_order.h"
#include "lte/tensor/functions.h"

namespace lte::nn {

QueryOrder::QueryOrder(const at::Tensor& position) {
  if (position.is_cpu() && position.size(0) > 1)
    order_ = ops::spatial_order(position.to(at::kFloat).contiguous());
}

at::Tensor QueryOrder::ordered(const at::Tensor& rows) const {
  return order_.defined() ? rows.index_select(0, order_) : rows;
}

QuerySet QueryOrder::ordered(const QuerySet& queries) const {
  return {ordered(queries.position), ordered(queries.normal), ordered(queries.albedo)};
}

at::Tensor QueryOrder::restored(const at::Tensor& rows) const {
  return order_.defined() ? at::empty_like(rows).index_copy_(0, order_, rows) : rows;
}

QuerySet block_of(const QuerySet& queries, int64_t begin, int64_t count) {
  return {queries.position.narrow(0, begin, count), queries.normal.narrow(0, begin, count),
          queries.albedo.narrow(0, begin, count)};
}

}  // namespace lte::nn
