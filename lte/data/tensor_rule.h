// What a file says of one of its tensors: the name, the shape, and which values are valid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "lte/base/math.h"

namespace lte::data {

/// What each entry of a tensor has to be. A vector counts as one entry.
enum class Values {
  Finite,
  NonNegative,  ///< and finite: radiance, irradiance, areas, counts
  Positive,     ///< and finite
  Share,        ///< in [0, 1]
  Albedo,       ///< each channel in [0, 1], to rounding
  Unit,         ///< a unit vector
  LightGroup,   ///< −1, or the index of a light group
  Mask,         ///< 0 or 1
};

struct TensorRule {
  std::string name;
  std::vector<int64_t> shape;  ///< of entries: a file adds a last axis of 3 to tensors of vectors
  Values values;
  /// Empty for a tensor that every file has. Otherwise the tensor is optional, and there if and
  /// only if the one of this name is: itself, or the first of those that come together.
  std::string with{};
  /// Where it is 0, entries are zero; each light group has the mask anew. Null for none.
  const std::vector<uint8_t>* mask = nullptr;

  bool optional() const { return !with.empty(); }
  int64_t entries() const {
    int64_t product = 1;
    for (const int64_t size : shape) product *= size;
    return product;
  }
};

/// What a file stores entries of type T as; its dtype follows (lte/base/safetensors.h).
template <typename T>
using ScalarOf = std::conditional_t<std::is_same_v<T, Vec3>, float, T>;

/// The tensor's shape in a file, whose last axis is 3 for vectors.
template <typename T>
std::vector<int64_t> file_shape(const TensorRule& rule) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  std::vector<int64_t> shape = rule.shape;
  if (std::is_same_v<T, Vec3>) shape.push_back(3);
  return shape;
}

}  // namespace lte::data
