// Tensors as arrays.
#pragma once

#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/base/math.h"

namespace lte::test {

/// [N] triples of a [N, 3] float tensor.
inline std::vector<Vec3> triples_of(const at::Tensor& tensor) {
  std::vector<Vec3> out;
  const float* values = tensor.const_data_ptr<float>();
  for (int64_t i = 0; i < tensor.size(0); ++i)
    out.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
  return out;
}

}  // namespace lte::test
