// Dense layers, y = x Wᵀ + b.
//
// On the CPU float32 goes through the products that all operators here share. ATen's linear calls
// MKL, which runs AVX2 code on AMD processors whatever they can do. oneDNN, in the same library, is
// as fast, or a quarter faster in narrow layers, but compiles code for every number of rows that it
// has not seen: a millisecond each, and scenes hardly ever have the same. Other dtypes and devices
// go to ATen.
#pragma once

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// @param x       [..., C] floating point
/// @param weight  [O, C], dtype and device of `x`, any strides; or bfloat16 with a float32 `x`:
///                products as in bf16.h, not differentiable
/// @param bias    [O] of the dtype of `x`, or undefined
/// @return  [..., O] of the dtype of `x`; differentiable once in all three
/// @throws c10::Error on shapes that disagree, and as at::linear on dtypes and devices that do
/// @note On the CPU each row's float32 result is the same bits whatever rows there are besides.
at::Tensor linear(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias = {});

/// linear() of training in mixed precision. What its product and the products of its backward pass
/// read (x, weight and gradient) is rounded to bfloat16 (bf16.h); sums, result and gradients are
/// float32. The backward pass keeps the rounded x and weight.
///
/// @param x, weight  float32; others are linear()'s
at::Tensor linear_autocast(const at::Tensor& x, const at::Tensor& weight,
                           const at::Tensor& bias = {});

/// gelu(linear(x, weight, bias)) with the exact (erf) form; one pass where no gradient is asked.
/// With bfloat16 weights GELU is within 2 · 10^-4, as the next product rounds it anyway.
at::Tensor linear_gelu(const at::Tensor& x, const at::Tensor& weight, const at::Tensor& bias = {});

}  // namespace lte::ops
