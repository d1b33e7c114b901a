#include "lte/nn/query_attention.h"

#include <ATen/ATen.h>

namespace lte::nn {

at::Tensor softmax_weights(Mlp& omega, const at::Tensor& relation) {
  return at::softmax(omega->forward(relation), 1);
}

at::Tensor softmax_attention(Mlp& omega, const at::Tensor& query, const at::Tensor& key,
                             const at::Tensor& value, const at::Tensor& place,
                             const at::Tensor& index) {
  const auto near = [&](const at::Tensor& rows) {
    return rows.index_select(0, index.reshape({-1})).view(place.sizes());
  };
  const at::Tensor relation = query.unsqueeze(1) - near(key) + place;
  return (softmax_weights(omega, relation) * (near(value) + place)).sum(1);
}

}  // namespace lte::nn
