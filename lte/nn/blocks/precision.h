// The arithmetic of the network's matrix products, in inference and in training.
#pragma once

#include <string>

#include "lte/base/enum_names.h"

namespace lte::nn {

/// Bf16: operands rounded to bfloat16, sums in float32 (lte/ops/bf16.h).
enum class Precision { Fp32, Bf16 };

constexpr EnumNames<Precision, 2> enum_names(Precision) {
  return {{{Precision::Fp32, "fp32"}, {Precision::Bf16, "bf16"}}};
}

}  // namespace lte::nn
