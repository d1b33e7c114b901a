// What tensors hold.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <type_traits>

#include "lte/tensor/own/error.h"

namespace lte::tensor {

/// The upper half of a float, rounded to nearest even.
struct BFloat16 {
  uint16_t x = 0;

  BFloat16() = default;
  BFloat16(float value) {
    const auto bits = std::bit_cast<uint32_t>(value);
    x = value != value ? uint16_t{0x7FC0}
                       : static_cast<uint16_t>((bits + 0x7FFF + ((bits >> 16) & 1)) >> 16);
  }
  operator float() const { return std::bit_cast<float>(static_cast<uint32_t>(x) << 16); }
};

enum class ScalarType : uint8_t { Bool, Byte, Int, Long, BFloat16, Float, Double };
inline constexpr ScalarType kBool = ScalarType::Bool, kByte = ScalarType::Byte,
                            kInt = ScalarType::Int, kLong = ScalarType::Long,
                            kBFloat16 = ScalarType::BFloat16, kFloat = ScalarType::Float,
                            kDouble = ScalarType::Double;

/// Calls use(T{}) with a number of the type.
template <typename Use>
decltype(auto) visit_type(ScalarType type, const Use& use) {
  switch (type) {
    case kBool:
      return use(bool{});
    case kByte:
      return use(uint8_t{});
    case kInt:
      return use(int32_t{});
    case kLong:
      return use(int64_t{});
    case kBFloat16:
      return use(BFloat16{});
    case kFloat:
      return use(float{});
    default:
      return use(double{});
  }
}

template <typename T>
constexpr ScalarType type_of() {
  if constexpr (std::is_same_v<T, bool>) return kBool;
  if constexpr (std::is_same_v<T, uint8_t>) return kByte;
  if constexpr (std::is_same_v<T, int32_t>) return kInt;
  if constexpr (std::is_same_v<T, int64_t>) return kLong;
  if constexpr (std::is_same_v<T, BFloat16>) return kBFloat16;
  if constexpr (std::is_same_v<T, float>) return kFloat;
  return kDouble;
}

inline size_t size_of(ScalarType type) {
  return visit_type(type, [](auto value) { return sizeof(value); });
}

inline bool isFloatingType(ScalarType type) { return type >= kBFloat16; }

inline const char* toString(ScalarType type) {
  constexpr const char* kNames[] = {"Bool", "Byte", "Int", "Long", "BFloat16", "Float", "Double"};
  return kNames[static_cast<size_t>(type)];
}

inline std::ostream& operator<<(std::ostream& out, ScalarType type) {
  return out << toString(type);
}

}  // namespace lte::tensor
