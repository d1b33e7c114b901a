// Dense layers, y = x Wᵀ + b, through the fastest matrix product that LibTorch carries.
//
// ATen's linear calls MKL, which runs AVX2 code on AMD processors whatever they can do. oneDNN, in
// the same library, takes AVX-512 on any processor that has it: 2.3 times the rate on a Zen 5, and
// level with MKL on an Intel one. Small products, other dtypes and other devices go to ATen.
//
// oneDNN is reached by `mkldnn::_linear_pointwise`, an operator that is private to LibTorch: its
// name and schema are LibTorch's to change. It is looked up when the program runs. Where it is
// missing, or switched off (at::globalContext().setUserEnabledMkldnn), everything goes to ATen.
#pragma once

#include <ATen/core/Tensor.h>

namespace lte::ops {

/// @param x       [..., C] floating point
/// @param weight  [O, C], dtype and device of `x`, any strides; or bfloat16 with a float32 `x`:
///                products as in bf16.h, not differentiable
/// @param bias    [O] of the dtype of `x`, or undefined
/// @return  [..., O] of the dtype of `x`; differentiable once in all three
/// @throws c10::Error on shapes that disagree, and as at::linear on dtypes and devices that do
/// @note Rounding may differ with the number of rows, as small products take another path.
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
