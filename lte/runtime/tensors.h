// From arrays of triples to tensors.
#pragma once

#include <span>

#include "lte/base/math.h"
#include "lte/tensor/functions.h"

namespace lte::runtime {

/// [N, 3] float32 on the CPU that borrows `triples`: do not write to it, and keep them alive.
inline at::Tensor borrow(std::span<const Vec3> triples) {
  return at::from_blob(const_cast<Vec3*>(triples.data()), {static_cast<int64_t>(triples.size()), 3},
                       at::TensorOptions(at::kFloat));
}

/// [N] float32, likewise.
inline at::Tensor borrow(std::span<const float> values) {
  return at::from_blob(const_cast<float*>(values.data()), {static_cast<int64_t>(values.size())},
                       at::TensorOptions(at::kFloat));
}

}  // namespace lte::runtime
