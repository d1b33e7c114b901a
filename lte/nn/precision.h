// The arithmetic of the network's matrix products, in inference and in training.
#pragma once

#include <string>

namespace lte::nn {

/// Bf16: operands rounded to bfloat16, sums in float32 (lte/ops/bf16.h).
enum class Precision { Fp32, Bf16 };

inline const char* precision_name(Precision precision) {
  return precision == Precision::Bf16 ? "bf16" : "fp32";
}

}  // namespace lte::nn
