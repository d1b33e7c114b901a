// Pointers and sizes of a C program, checked and made tensors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <ATen/core/Tensor.h>

#include "lte/c_api/error.h"

namespace lte::c_api {

/// Bytes by which a later version's struct may be longer; more is a struct_size that nobody set.
inline constexpr size_t kGrowth = 4096;

/// The caller's struct.
/// @throws ApiError if it is null, shorter than ours, or longer and used there.
template <typename T>
T read_struct(const T* from, const char* name) {
  require(from != nullptr, name, " is null");
  size_t size = 0;
  std::memcpy(&size, from, sizeof size);
  require(size >= sizeof(T) && size <= sizeof(T) + kGrowth, name, ": struct_size is ", size,
          ", expected sizeof(", name, "), ", sizeof(T));
  const auto* bytes = reinterpret_cast<const char*>(from);
  const bool later = std::any_of(bytes + sizeof(T), bytes + size, [](char b) { return b != 0; });
  require(!later, name, " has fields that this library, version ", LTE_C_API_VERSION,
          " of the interface, does not know");
  require(from->reserved == 0, name, ": reserved is ", from->reserved, ", expected 0");
  return *from;
}

/// Fills the caller's struct; what a later version has at the end stays as it is.
template <typename T>
void write_struct(T values, T* to, const char* name) {
  require(to != nullptr, name, " is null");
  require(to->struct_size >= sizeof(T), name, ": struct_size is ", to->struct_size,
          ", expected sizeof(", name, "), ", sizeof(T));
  values.struct_size = to->struct_size;
  *to = values;
}

/// [count, 3] float32 that borrows the view's memory on `device`; do not write to it.
/// @throws ApiError naming `name` for null, misaligned, a bad stride, or memory of another device.
at::Tensor borrow_triples(const lte_float3_view& view, int64_t count, at::Device device,
                          const char* name);

/// The same to be written to.
at::Tensor borrow_output(float* data, int64_t stride, int64_t count, at::Device device,
                         const char* name);

/// [count] float32, without gaps.
at::Tensor borrow_floats(const float* data, int64_t count, at::Device device, const char* name);

/// [count] bool: which entries of a mask are not 0.
at::Tensor read_mask(const uint8_t* mask, int64_t stride, int64_t count, at::Device device);

/// @throws ApiError naming `name` unless all three are finite.
void check_finite_triple(const float* values, const char* name);

}  // namespace lte::c_api
