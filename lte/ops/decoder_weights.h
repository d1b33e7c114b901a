// The weights of the query decoder by name, and as the list of tensors that the operator's schema
// takes.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// y = x Wᵀ + b: weight [outputs, inputs], bias [outputs].
struct LinearWeights {
  at::Tensor weight, bias;
  /// Training in mixed precision: the weight in bfloat16 (bf16.h), which products read in its
  /// place; gradients are those by `weight`. Undefined: they read `weight`.
  at::Tensor rounded = {};

  const at::Tensor& as_read() const { return rounded.defined() ? rounded : weight; }

  int64_t inputs() const { return weight.size(1); }
  int64_t outputs() const { return weight.size(0); }
};

/// LayerNorm's: both [C].
struct NormWeights {
  at::Tensor gain, bias;
};

/// Linear, GELU, linear.
struct PerceptronWeights {
  LinearWeights hidden, output;
};

/// One layer of the decoder: G += output(A) with A made from query(norm1(G)) and the sums over the
/// neighbours, then G += ffn(norm2(G)).
struct LayerWeights {
  NormWeights norm1;
  LinearWeights query, output;
  NormWeights norm2;
  PerceptronWeights ffn;
};

/// Everything that query_decoder_inference() multiplies by.
struct DecoderWeights {
  PerceptronWeights point;  ///< A -> . -> C, of the queries' own attributes
  PerceptronWeights gamma;  ///< γ, F -> H -> C, of the geometry of the pairs with the neighbours
  std::vector<LayerWeights> layers;
  NormWeights norm;
  PerceptronWeights head;  ///< C -> . -> O

  /// All tensors: point, gamma, the layers in their order, norm, head; of each the members in the
  /// order of their declarations.
  std::vector<at::Tensor> to_list() const;
  /// The same with what products read, LinearWeights::as_read().
  std::vector<at::Tensor> list_as_read() const;

  /// The weights of a decoder of `layers` layers from to_list()'s list.
  /// @throws c10::Error if the list is not as long as that
  static DecoderWeights from_list(at::TensorList list, int64_t layers);
};

}  // namespace lte::ops
