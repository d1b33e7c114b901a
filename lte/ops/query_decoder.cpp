#include "lte/ops/query_decoder.h"

#include <optional>

#include <torch/library.h>

#include "lte/ops/dispatch.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "query_decoder_inference(Tensor attributes, Tensor position, Tensor anchor, Tensor index, "
      "float scale, float limit, Tensor? normal, Tensor? anchor_normal, Tensor table, "
      "Tensor[] weights) -> Tensor");
  m.def("spatial_order(Tensor points) -> Tensor");
}

namespace lte::ops {
namespace {

std::optional<at::Tensor> optional(const at::Tensor& t) {
  return t.defined() ? std::optional(t) : std::nullopt;
}

}  // namespace

at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, const DecoderWeights& weights) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&,
                               const at::Tensor&, double, double, const std::optional<at::Tensor>&,
                               const std::optional<at::Tensor>&, const at::Tensor&, at::TensorList);
  static const auto op = find_operator<Signature>("lte::query_decoder_inference");
  return op.call(attributes, near.position, near.anchor, near.index, near.scale, near.limit,
                 optional(near.normal), optional(near.anchor_normal), table, weights.to_list());
}

at::Tensor spatial_order(const at::Tensor& points) {
  static const auto op = find_operator<decltype(spatial_order)>("lte::spatial_order");
  return op.call(points);
}

}  // namespace lte::ops
