// Loops over tensors of one shape and any strides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lte/tensor/own/tensor.h"

namespace lte::tensor {

/// Calls run(pointers, steps, count) for runs of numbers, such that all of `sizes` are visited in
/// order. Neighbouring axes that every tensor walks through evenly are one.
/// @param tensors  their strides are read; those of axes of size 1 count for nothing
template <size_t N, typename Run>
void over_runs(IntArrayRef sizes, const std::array<const Tensor*, N>& tensors, const Run& run) {
  std::array<int64_t, kMaxDims> size{};
  std::array<std::array<int64_t, N>, kMaxDims> stride{};
  size_t axes = 0;
  for (size_t axis = 0; axis < sizes.size(); ++axis) {
    if (sizes[axis] == 0) return;
    if (sizes[axis] == 1) continue;
    std::array<int64_t, N> steps{};
    bool joins = axes > 0;
    for (size_t n = 0; n < N; ++n) {
      steps[n] = tensors[n]->strides()[axis];
      joins = joins && stride[axes - 1][n] == steps[n] * sizes[axis];
    }
    if (joins) {
      size[axes - 1] *= sizes[axis];
      stride[axes - 1] = steps;
    } else {
      size[axes] = sizes[axis];
      stride[axes++] = steps;
    }
  }
  if (axes == 0) size[axes++] = 1;
  std::array<std::byte*, N> at{};
  std::array<int64_t, N> width{};
  for (size_t n = 0; n < N; ++n) {
    at[n] = tensors[n]->bytes();
    width[n] = static_cast<int64_t>(tensors[n]->element_size());
  }
  std::array<int64_t, kMaxDims> index{};
  const size_t last = axes - 1;
  while (true) {
    run(at, stride[last], size[last]);
    size_t axis = last;
    while (axis > 0) {
      --axis;
      for (size_t n = 0; n < N; ++n) at[n] += stride[axis][n] * width[n];
      if (++index[axis] < size[axis]) break;
      for (size_t n = 0; n < N; ++n) at[n] -= size[axis] * stride[axis][n] * width[n];
      index[axis] = 0;
      if (axis == 0) return;
    }
    if (last == 0) return;
  }
}

/// The shape that both broadcast to.
struct BroadcastShape {
  std::array<int64_t, kMaxDims> sizes{};
  size_t dims = 0;

  BroadcastShape(IntArrayRef a, IntArrayRef b) : dims(std::max(a.size(), b.size())) {
    for (size_t i = 0; i < dims; ++i) {
      const int64_t of_a = i < a.size() ? a[a.size() - 1 - i] : 1,
                    of_b = i < b.size() ? b[b.size() - 1 - i] : 1;
      TORCH_CHECK(of_a == of_b || of_a == 1 || of_b == 1, "shapes ", a, " and ", b, " differ");
      sizes[dims - 1 - i] = of_a == 1 ? of_b : of_a;
    }
  }
  operator IntArrayRef() const { return {sizes.data(), dims}; }
};

/// out = of(a) by number; `out` has a's shape.
template <typename A, typename Out, typename Of>
void map_into(const Tensor& out, const Tensor& a, const Of& of) {
  over_runs<2>(out.sizes(), {&out, &a}, [&](const auto& at, const auto& step, int64_t count) {
    auto* to = reinterpret_cast<Out*>(at[0]);
    const auto* from = reinterpret_cast<const A*>(at[1]);
    if (step[0] == 1 && step[1] == 1) {
      for (int64_t i = 0; i < count; ++i) to[i] = of(from[i]);
    } else {
      for (int64_t i = 0; i < count; ++i) to[i * step[0]] = of(from[i * step[1]]);
    }
  });
}

/// of(a, b) by number of two tensors of type T that broadcast.
template <typename T, typename Out, typename Of>
Tensor combined(const Tensor& a, const Tensor& b, const Of& of) {
  const BroadcastShape shape(a.sizes(), b.sizes());
  const Tensor out(shape, type_of<Out>()), wide_a = a.expand(shape), wide_b = b.expand(shape);
  over_runs<3>(shape, {&out, &wide_a, &wide_b},
               [&](const auto& at, const auto& step, int64_t count) {
                 auto* to = reinterpret_cast<Out*>(at[0]);
                 const auto* x = reinterpret_cast<const T*>(at[1]);
                 const auto* y = reinterpret_cast<const T*>(at[2]);
                 if (step[1] == 1 && step[2] == 1) {
                   for (int64_t i = 0; i < count; ++i) to[i] = of(x[i], y[i]);
                 } else {
                   for (int64_t i = 0; i < count; ++i)
                     to[i * step[0]] = of(x[i * step[1]], y[i * step[2]]);
                 }
               });
  return out;
}

}  // namespace lte::tensor
