// The query decoder's forward pass in one operator: what nn::QueryDecoder computes (docs/model.md,
// "Local query decoder").
//
// The CPU takes tiles of queries whose every intermediate stays in the caches of one core. CUDA
// takes blocks of queries and gathers and sums their neighbours in one kernel.
#pragma once

#include <cstdint>
#include <memory>

#include "lte/ops/decoder_weights.h"
#include "lte/ops/pair_geometry.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Where the queries are and what is near them.
struct QueryNeighbourhood {
  at::Tensor position;  ///< [Q, 3] float32
  at::Tensor anchor;    ///< [m, 3] float32, of the latents
  at::Tensor index;     ///< [Q, K] int64, the latents near each query, in [0, m); K >= 1
  double scale = 1;     ///< offsets are (position − anchor) * scale,
  double limit = 1;     ///< limited to ±limit
  /// [Q, 3] and [m, 3] float32, unit: of decoders whose γ reads kNormalInputs columns; else both
  /// undefined.
  at::Tensor normal = {}, anchor_normal = {};
};

/// @param attributes  [Q, A] float32, what the queries' own MLP sees
/// @param table       neighbour_table() of L layers and C channels, float32
/// @param weights     of L layers, float32; dense weights but that of `gamma.hidden` may be
///                    bfloat16 instead (bf16.h)
/// @return  [Q, O], softplus of the head
/// @throws c10::Error on a wrong shape, dtype, device or number of weights, or, on the CPU, an
///         index out of range; on CUDA such an index fails a device-side assertion
/// @note Not differentiable. On the CPU each query's result is the same bits whatever other queries
///       there are, in whatever order; the order of spatial_order() (spatial_order.h) is fastest.
/// @note CPU: some 2 MB of working memory a thread at C = 128 and L = 6, and a copy of the weights.
///       CUDA: 150 MB for blocks of 16,384 queries; products follow LibTorch's switch for TF32; the
///       host waits for nothing.
at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, const DecoderWeights& weights);

/// A decoder's weights as the CPU's tiles read them.
struct PackedDecoder;

/// @param weights  as query_decoder_inference() takes them, on the CPU; they are copied
/// @throws c10::Error on a wrong shape, dtype or device
std::shared_ptr<const PackedDecoder> pack_decoder(const DecoderWeights& weights);

/// The same from weights that were packed before, which takes a call of few queries most of its
/// time. CPU only; the same bits.
at::Tensor query_decoder_inference(const at::Tensor& attributes, const QueryNeighbourhood& near,
                                   const at::Tensor& table, const PackedDecoder& weights);

/// query_decoder_inference() for training: differentiable once in table and weights, not in the
/// queries. The backward pass computes a tile's intermediates again, so that nothing of the size of
/// queries × neighbours is ever in memory.
///
/// @param weights  float32; dense ones but that of `gamma.hidden` may have a rounding, by which
///                 mixed precision rounds inputs and gradients too as products read them
/// @note CPU only. The same bits for any number of threads, gradients included.
at::Tensor query_decoder(const at::Tensor& attributes, const QueryNeighbourhood& near,
                         const at::Tensor& table, const DecoderWeights& weights);

}  // namespace lte::ops
