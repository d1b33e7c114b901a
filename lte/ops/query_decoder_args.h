// What query_decoder_inference(), query_decoder() and its gradient accept, and the sizes that their
// arguments agree on.
#pragma once

#include <string>

#include "lte/ops/arguments.h"
#include "lte/ops/decoder_weights.h"
#include "lte/ops/neighbour_sums_args.h"
#include "lte/ops/query_decoder.h"

namespace lte::ops {

struct DecoderSizes {
  int64_t queries, attributes, neighbours, layers, latents, channels, gamma_inputs, gamma_hidden,
      outputs;
};

/// The layers that `table` holds, whatever else it is: how long the list of weights has to be.
inline int64_t table_layers(const at::Tensor& table) {
  const int64_t axis = table.is_cpu() ? 2 : 1;
  TORCH_CHECK(table.dim() > axis,
              "query_decoder_inference: table must come from neighbour_table(), got ",
              table.sizes());
  return table.size(axis);
}

/// Checks weights one by one: names, shapes, dtypes and the table's device.
class DecoderWeightsCheck {
 public:
  explicit DecoderWeightsCheck(const at::Device& device) : device_(device) {}

  void norm(const NormWeights& w, int64_t channels, const std::string& name) const {
    vector(w.gain, channels, name);
    vector(w.bias, channels, name);
  }

  /// Any number of outputs.
  void linear(const LinearWeights& w, int64_t inputs, const std::string& name,
              bool may_be_bf16 = true) const {
    TORCH_CHECK(w.weight.dim() == 2 && w.weight.size(1) == inputs && w.weight.size(0) >= 1 &&
                    (w.weight.scalar_type() == at::kFloat ||
                     (may_be_bf16 && w.weight.scalar_type() == at::kBFloat16)) &&
                    w.weight.device() == device_,
                kOp, ": ", name, " must be [outputs, ", inputs, "] float32",
                may_be_bf16 ? " or bfloat16" : "", " on ", device_, ", got ", w.weight.sizes(), " ",
                w.weight.scalar_type(), " on ", w.weight.device());
    vector(w.bias, w.weight.size(0), name);
  }

  void linear(const LinearWeights& w, int64_t inputs, int64_t outputs,
              const std::string& name) const {
    linear(w, inputs, name);
    TORCH_CHECK(w.weight.size(0) == outputs, kOp, ": ", name, " must be [", outputs, ", ", inputs,
                "], got ", w.weight.sizes());
  }

  void perceptron(const PerceptronWeights& w, int64_t inputs, int64_t outputs,
                  const std::string& name) const {
    linear(w.hidden, inputs, name + ".hidden");
    linear(w.output, w.hidden.outputs(), outputs, name + ".output");
  }

 private:
  static constexpr const char* kOp = "query_decoder_inference";

  void vector(const at::Tensor& t, int64_t size, const std::string& name) const {
    TORCH_CHECK(
        t.dim() == 1 && t.size(0) == size && t.scalar_type() == at::kFloat && t.device() == device_,
        kOp, ": ", name, "'s vectors must be [", size, "] float32 on ", device_, ", got ",
        t.sizes(), " ", t.scalar_type(), " on ", t.device());
  }

  at::Device device_;
};

inline void check_decoder_weights(const DecoderWeights& w, int64_t attributes, int64_t gamma_inputs,
                                  int64_t C, const at::Device& device) {
  const DecoderWeightsCheck check(device);
  check.perceptron(w.point, attributes, C, "point");
  check.linear(w.gamma.hidden, gamma_inputs, "gamma.hidden", /*may_be_bf16=*/false);
  check.linear(w.gamma.output, w.gamma.hidden.outputs(), C, "gamma.output");
  for (const LayerWeights& layer : w.layers) {
    check.norm(layer.norm1, C, "norm1");
    check.linear(layer.query, C, C, "query");
    check.linear(layer.output, C, C, "output");
    check.norm(layer.norm2, C, "norm2");
    check.perceptron(layer.ffn, C, C, "ffn");
  }
  check.norm(w.norm, C, "norm");
  check.linear(w.head.hidden, C, "head.hidden");
  check.linear(w.head.output, w.head.hidden.outputs(), "head.output");
}

/// What the weights fix of the sizes.
struct DecoderShape {
  int64_t attributes, channels, gamma_inputs, gamma_hidden, outputs;
};

/// Checks everything but the weights.
/// @param shape  all but the number of attributes and of γ's inputs, which are the queries'
inline DecoderSizes check_decoder_queries(const at::Tensor& attributes,
                                          const QueryNeighbourhood& near, const at::Tensor& table,
                                          const DecoderShape& shape) {
  const char* op = "query_decoder_inference";
  TORCH_CHECK(attributes.dim() == 2 && attributes.scalar_type() == at::kFloat, op,
              ": attributes must be [Q, A] float32, got ", attributes.sizes(), " ",
              attributes.scalar_type());
  const int64_t Q = attributes.size(0), C = shape.channels;
  const TableSizes sizes = check_table(table, C, op);
  check_shape(near.position, {Q, 3}, at::kFloat, op, "position");
  TORCH_CHECK(near.anchor.dim() == 2 && near.anchor.size(0) == sizes.latents, op,
              ": table must come from neighbour_table() for the anchors, got ", sizes.latents,
              " latents and anchors ", near.anchor.sizes());
  check_shape(near.anchor, {sizes.latents, 3}, at::kFloat, op, "anchor");
  check_neighbours(near.index, Q, sizes.latents, op);
  TORCH_CHECK(near.index.size(1) >= 1, op, ": sums over no neighbours");
  TORCH_CHECK(near.normal.defined() == near.anchor_normal.defined(), op,
              ": normals of queries and of anchors go together");
  if (near.normal.defined()) {
    check_shape(near.normal, {Q, 3}, at::kFloat, op, "normal");
    check_shape(near.anchor_normal, {sizes.latents, 3}, at::kFloat, op, "anchor_normal");
  }
  for (const at::Tensor& t :
       {attributes, near.position, near.anchor, near.index, near.normal, near.anchor_normal}) {
    if (!t.defined()) continue;
    check_device(t, "the queries and anchors", table, "tables", op);
  }
  const int64_t gamma_inputs = near.normal.defined() ? kNormalInputs : kOffsetInputs;
  return {Q, attributes.size(1), near.index.size(1), sizes.layers, sizes.latents,
          C, gamma_inputs,       shape.gamma_hidden, shape.outputs};
}

inline DecoderSizes check_query_decoder_args(const at::Tensor& attributes,
                                             const QueryNeighbourhood& near,
                                             const at::Tensor& table, const DecoderWeights& w) {
  const char* op = "query_decoder_inference";
  const at::Tensor &gamma = w.gamma.output.weight, &head = w.head.output.weight;
  TORCH_CHECK(gamma.dim() == 2, op, ": gamma.output must be [C, H], got ", gamma.sizes());
  TORCH_CHECK(head.dim() == 2, op, ": head.output must be [O, C], got ", head.sizes());
  const DecoderSizes sizes = check_decoder_queries(
      attributes, near, table, {0, gamma.size(0), 0, gamma.size(1), head.size(0)});
  check_decoder_weights(w, sizes.attributes, sizes.gamma_inputs, sizes.channels, table.device());
  return sizes;
}

/// The same backwards; `sums` are those of the forward pass.
inline void check_query_decoder_backward_args(const at::Tensor& grad, const at::Tensor& sums,
                                              const DecoderSizes& sizes) {
  const char* op = "query_decoder_backward";
  check_shape(grad, {sizes.queries, sizes.outputs}, at::kFloat, op, "grad");
  check_shape(sums,
              {sizes.queries, (sizes.channels + kTableBlock - 1) / kTableBlock, sizes.layers, 2,
               kTableBlock},
              at::kFloat, op, "sums");
}

}  // namespace lte::ops
