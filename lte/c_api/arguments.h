// Pointers and sizes of a C program, checked, as lte::runtime takes them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "lte/c_api/error.h"
#include "lte/runtime/device_memory.h"

namespace lte::c_api {

/// Bytes by which a later version's struct may be longer; more means that struct_size was not set.
inline constexpr size_t kGrowth = 4096;

/// Returns a copy of the caller's struct; fields that it does not have yet are 0.
/// @param first  its size when the interface's version was new: callers built then have that much
/// @throws ApiError if it is null, shorter, or longer than ours with anything but zeros at the end.
template <typename T>
T read_struct(const T* from, const char* name, size_t first = sizeof(T)) {
  require(from != nullptr, name, " is null");
  size_t size = 0;
  std::memcpy(&size, from, sizeof size);
  require(size >= first && size <= sizeof(T) + kGrowth, name, ": struct_size is ", size,
          ", expected sizeof(", name, "), ", sizeof(T));
  const auto* bytes = reinterpret_cast<const char*>(from);
  const auto* end = bytes + size;
  const bool later =
      size > sizeof(T) && std::any_of(bytes + sizeof(T), end, [](char b) { return b != 0; });
  require(!later, name, " has fields that this library, version ", LTE_C_API_VERSION,
          " of the interface, does not know");
  T values = {};
  std::memcpy(&values, from, std::min(size, sizeof(T)));
  if constexpr (requires { values.reserved; })
    require(values.reserved == 0, name, ": reserved is ", values.reserved, ", expected 0");
  return values;
}

/// Fills the caller's struct as far as it goes; fields that a later version has at the end stay as
/// they are.
/// @param first  its size when the interface's version was new: callers built then have that much
template <typename T>
void write_struct(T values, T* to, const char* name, size_t first = sizeof(T)) {
  require(to != nullptr, name, " is null");
  size_t size = 0;
  std::memcpy(&size, to, sizeof size);
  require(size >= first, name, ": struct_size is ", size, ", expected sizeof(", name, "), ",
          sizeof(T));
  values.struct_size = size;
  std::memcpy(to, &values, std::min(size, sizeof(T)));
}

/// @param number  LTE_DEVICE_CPU or a CUDA device's number
/// @throws ApiError if it is neither, runtime::NoDevice if there is no such device.
runtime::Device device_of(int32_t number);

/// @throws ApiError naming `name` for null, misaligned, a bad stride, or more than there are
///         addresses.
runtime::TriplesIn read_triples(const lte_float3_view& view, int64_t count, const char* name);

/// The same to be written to.
runtime::TriplesOut read_output(float* data, int64_t stride, int64_t count, const char* name);

/// @param memory  where the arrays are
runtime::ScenePointsIn read_points(const lte_scene_points& points, runtime::Device memory);
/// @param albedo  whether it is read
runtime::QueriesIn read_queries(const lte_queries& queries, runtime::Device memory,
                                bool albedo = true);

/// @throws ApiError naming `name` unless all three are finite.
void check_finite_triple(const float* values, const char* name);

}  // namespace lte::c_api
