// bfloat16 on the CPU: an operator whose weights are bfloat16 rounds its float32 activations to
// bfloat16 as its matrix products read them, and sums in float32. Norms, activation functions,
// residuals and sums over neighbours stay in float32.
#pragma once

namespace lte::ops {

/// True if the processor multiplies bfloat16 itself (AVX512-BF16 or AMX). Elsewhere the same
/// products are made of float32 instructions, and bfloat16 is slower than float32.
bool has_bf16_products();

}  // namespace lte::ops
