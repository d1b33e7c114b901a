#include "lte/ops/query_decoder.h"

#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "query_decoder_inference(Tensor attributes, Tensor position, Tensor anchor, Tensor index, "
      "float scale, float limit, Tensor? normal, Tensor? anchor_normal, Tensor table, "
      "Tensor[] weights) -> Tensor");
  // The answers, and the sums over the neighbours that query_decoder_backward() reads.
  m.def(
      "query_decoder(Tensor attributes, Tensor position, Tensor anchor, Tensor index, float scale, "
      "float limit, Tensor? normal, Tensor? anchor_normal, Tensor table, Tensor[] weights) -> "
      "(Tensor, Tensor)");
  // Gradients by the table and by each of the weights.
  m.def(
      "query_decoder_backward(Tensor grad, Tensor attributes, Tensor position, Tensor anchor, "
      "Tensor index, float scale, float limit, Tensor? normal, Tensor? anchor_normal, "
      "Tensor table, Tensor sums, Tensor[] weights) -> (Tensor, Tensor[])");
}

namespace lte::ops {
namespace {

std::optional<at::Tensor> optional(const at::Tensor& t) {
  return t.defined() ? std::optional(t) : std::nullopt;
}

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// What no gradient goes through.
struct DecoderQueries : torch::CustomClassHolder {
  at::Tensor attributes;
  QueryNeighbourhood near;
};

class QueryDecoder : public torch::autograd::Function<QueryDecoder> {
 public:
  static at::Tensor forward(AutogradContext* context,
                            const c10::intrusive_ptr<DecoderQueries>& queries,
                            const at::Tensor& table, at::TensorList /*weights*/,
                            at::TensorList read) {
    using Signature = std::tuple<at::Tensor, at::Tensor>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&, double, double,
        const std::optional<at::Tensor>&, const std::optional<at::Tensor>&, const at::Tensor&,
        at::TensorList);
    static const auto op = find_operator<Signature>("lte::query_decoder");
    const at::AutoDispatchBelowADInplaceOrView below;
    const QueryNeighbourhood& near = queries->near;
    const auto [out, sums] =
        op.call(queries->attributes, near.position, near.anchor, near.index, near.scale, near.limit,
                optional(near.normal), optional(near.anchor_normal), table, read);
    context->saved_data["queries"] = c10::IValue::make_capsule(queries);
    variable_list saved = {table, sums};
    saved.insert(saved.end(), read.begin(), read.end());
    context->save_for_backward(std::move(saved));
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature = std::tuple<at::Tensor, std::vector<at::Tensor>>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
        const at::Tensor&, double, double, const std::optional<at::Tensor>&,
        const std::optional<at::Tensor>&, const at::Tensor&, const at::Tensor&, at::TensorList);
    static const auto op = find_operator<Signature>("lte::query_decoder_backward");
    const auto holder = context->saved_data["queries"].toCapsule();
    const auto& queries = static_cast<const DecoderQueries&>(*holder);
    const QueryNeighbourhood& near = queries.near;
    const variable_list saved = context->get_saved_variables();
    const auto [table, weights] =
        op.call(grads[0], queries.attributes, near.position, near.anchor, near.index, near.scale,
                near.limit, optional(near.normal), optional(near.anchor_normal), saved[0], saved[1],
                at::TensorList(saved).slice(2));
    variable_list out = {at::Tensor(), table};
    out.insert(out.end(), weights.begin(), weights.end());
    out.resize(out.size() + weights.size());  // none by what products read
    return out;
  }
};

}  // namespace

at::Tensor query_decoder(const at::Tensor& attributes, const QueryNeighbourhood& near,
                         const at::Tensor& table, const DecoderWeights& weights) {
  for (const at::Tensor& t : {attributes, near.position, near.anchor}) {
    TORCH_CHECK(!t.requires_grad(), "query_decoder: there are no gradients by the queries");
  }
  const auto queries = c10::make_intrusive<DecoderQueries>();
  queries->attributes = attributes;
  queries->near = near;
  const std::vector<at::Tensor> list = weights.to_list(), read = weights.list_as_read();
  return QueryDecoder::apply(queries, table, at::TensorList(list), at::TensorList(read));
}

at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, const DecoderWeights& weights) {
  using Signature = at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&,
                               const at::Tensor&, double, double, const std::optional<at::Tensor>&,
                               const std::optional<at::Tensor>&, const at::Tensor&, at::TensorList);
  static const auto op = find_operator<Signature>("lte::query_decoder_inference");
  return op.call(attributes, near.position, near.anchor, near.index, near.scale, near.limit,
                 optional(near.normal), optional(near.anchor_normal), table, weights.to_list());
}

}  // namespace lte::ops
