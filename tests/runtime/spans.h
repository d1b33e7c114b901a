// Rows of a tensor as the headers of lte/runtime take them.
#pragma once

#include <span>

#include "lte/tensor/tensor.h"

namespace lte::test {

/// @param t  contiguous on the CPU, with rows of a T
template <typename T>
std::span<const T> span(const at::Tensor& t) {
  return {static_cast<const T*>(t.const_data_ptr()), static_cast<size_t>(t.size(0))};
}

}  // namespace lte::test
