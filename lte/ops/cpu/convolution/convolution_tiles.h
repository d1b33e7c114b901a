// Submanifold convolution and its gradients by the dense kernels: runs of pairs are gathered into
// tiles that stay in the cache, multiplied and added to their rows.
//
// float32, or bfloat16 with sums in float32, with whole blocks of channels. Blocks of work are the
// same for any number of threads, so results do not depend on it.
#pragma once

#include <cstdint>

#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/tap_weights.h"

namespace lte::ops {

/// Which input row each tap of each output row reads.
struct ConvolutionPairs {
  const int32_t *output, *input;  ///< [count]; the pairs of a tap are sorted by output
  const int64_t* begin;           ///< [taps + 1], where each tap's pairs start
  int64_t count, taps;
};

/// Features [N, C], contiguous.
struct ConvolutionRows {
  const float* values;
  int64_t N, C;
};

/// Whether features of so many channels fill whole blocks.
inline bool suits_tiles(int64_t channels) { return channels % kBlock == 0; }

/// out[N, outputs] += the convolution of `input` with `weights` of C inputs.
void convolve_tiles(const ConvolutionRows& input, const TapWeights& weights,
                    const ConvolutionPairs& pairs, float* out);

/// out[N, inputs] += the gradient by the input. `grad` [N, C] is the gradient by the output,
/// `weight` is [taps, inputs, C].
void input_gradient_tiles(const ConvolutionRows& grad, const float* weight, int64_t inputs,
                          const ConvolutionPairs& pairs, float* out);
/// The same with a bfloat16 weight; `grad` is rounded as it is read.
void input_gradient_tiles(const ConvolutionRows& grad, const at::BFloat16* weight, int64_t inputs,
                          const ConvolutionPairs& pairs, float* out);

/// out[taps, input.C, grad.C] += the gradient by the weight.
void weight_gradient_tiles(const ConvolutionRows& input, const ConvolutionRows& grad,
                           const ConvolutionPairs& pairs, float* out);
/// The same from an input [N, inputs] that was rounded before; `grad` is rounded as it is read.
void weight_gradient_tiles(const at::BFloat16* input, int64_t inputs, const ConvolutionRows& grad,
                           const ConvolutionPairs& pairs, float* out);

}  // namespace lte::ops
