// Arithmetic number by number.
#include <cmath>
#include <functional>
#include <type_traits>

#include "lte/tensor/own/functions.h"
#include "lte/tensor/own/strided.h"

namespace lte::tensor {
namespace {

/// A number as a tensor that broadcasts, in the type of `other`.
Tensor like(const Scalar& value, const Tensor& other) {
  TORCH_CHECK(!value.is_real() || isFloatingType(other.scalar_type()), "a real number meets ",
              other.scalar_type());
  return full({}, value, other.scalar_type());
}

void check_types(const Tensor& a, const Tensor& b) {
  TORCH_CHECK(a.scalar_type() == b.scalar_type(), "operands of types ", a.scalar_type(), " and ",
              b.scalar_type());
}

/// of(a, b) for the types that compute.
template <typename Of>
Tensor arithmetic(const Tensor& a, const Tensor& b, const Of& of) {
  check_types(a, b);
  return visit_type(a.scalar_type(), [&](auto type) -> Tensor {
    using T = decltype(type);
    if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, BFloat16>) {
      TORCH_CHECK(false, "no arithmetic of ", a.scalar_type());
    } else {
      return combined<T, T>(a, b, [&](T x, T y) { return static_cast<T>(of(x, y)); });
    }
  });
}

template <typename Of>
Tensor compared(const Tensor& a, const Tensor& b, const Of& of) {
  check_types(a, b);
  return visit_type(a.scalar_type(), [&](auto type) {
    using T = decltype(type);
    return combined<T, bool>(a, b, [&](const T& x, const T& y) { return of(x, y); });
  });
}

/// of(t) of float32 or float64.
template <typename Of>
Tensor mapped(const Tensor& t, const Of& of) {
  const Tensor out = empty_like(t);
  AT_DISPATCH_FLOATING_TYPES(t.scalar_type(), "a function", [&] {
    map_into<scalar_t, scalar_t>(out, t, [&](scalar_t x) { return of(x); });
  });
  return out;
}

/// What is not a number stays.
template <typename T>
T clamped(T x, T low, T high) {
  return x < low ? low : (x > high ? high : x);
}

}  // namespace

Tensor Tensor::add(const Tensor& other) const { return arithmetic(*this, other, std::plus<>()); }
Tensor Tensor::sub(const Tensor& other) const { return arithmetic(*this, other, std::minus<>()); }
Tensor Tensor::mul(const Tensor& other) const {
  return arithmetic(*this, other, std::multiplies<>());
}
Tensor Tensor::div(const Tensor& other) const {
  TORCH_CHECK(isFloatingType(scalar_type()), "whole numbers are divided with rounding alone");
  return arithmetic(*this, other, std::divides<>());
}
Tensor Tensor::add(const Scalar& other) const { return add(like(other, *this)); }
Tensor Tensor::sub(const Scalar& other) const { return sub(like(other, *this)); }
Tensor Tensor::mul(const Scalar& other) const { return mul(like(other, *this)); }
Tensor Tensor::div(const Scalar& other) const { return div(like(other, *this)); }
Tensor operator-(const Scalar& a, const Tensor& b) { return like(a, b).sub(b); }

Tensor Tensor::div(const Scalar& other, const char* rounding) const {
  TORCH_CHECK(std::string_view(rounding) == "floor", "rounding ", rounding);
  return arithmetic(*this, like(other, *this), [](auto x, auto y) {
    if constexpr (std::is_floating_point_v<decltype(x)>) {
      return std::floor(x / y);
    } else {
      const int64_t whole = x / y;
      return x % y != 0 && (x < 0) != (y < 0) ? whole - 1 : whole;
    }
  });
}

Tensor Tensor::eq(const Tensor& other) const { return compared(*this, other, std::equal_to<>()); }
Tensor Tensor::ne(const Tensor& other) const {
  return compared(*this, other, std::not_equal_to<>());
}
Tensor Tensor::gt(const Tensor& other) const { return compared(*this, other, std::greater<>()); }
Tensor Tensor::eq(const Scalar& other) const { return eq(like(other, *this)); }
Tensor Tensor::ne(const Scalar& other) const { return ne(like(other, *this)); }
Tensor Tensor::gt(const Scalar& other) const { return gt(like(other, *this)); }
Tensor Tensor::ge(const Scalar& other) const {
  return compared(*this, like(other, *this), std::greater_equal<>());
}
Tensor Tensor::le(const Scalar& other) const {
  return compared(*this, like(other, *this), std::less_equal<>());
}
Tensor Tensor::logical_and(const Tensor& other) const {
  return compared(*this, other, [](bool x, bool y) { return x && y; });
}
Tensor Tensor::logical_not() const {
  return compared(*this, *this, [](bool x, bool) { return !x; });
}

Tensor Tensor::bitwise_right_shift(int64_t bits) const {
  return arithmetic(*this, full({}, bits, scalar_type()), [](auto x, auto y) {
    TORCH_CHECK(std::is_integral_v<decltype(x)>, "bits of numbers that are not whole");
    return static_cast<int64_t>(x) >> static_cast<int64_t>(y);
  });
}

const Tensor& Tensor::mul_(const Scalar& factor) const {
  AT_DISPATCH_FLOATING_TYPES(scalar_type(), "mul_", [&] {
    const auto by = factor.to<scalar_t>();
    map_into<scalar_t, scalar_t>(*this, *this, [by](scalar_t x) { return x * by; });
  });
  return *this;
}
const Tensor& Tensor::clamp_(const Scalar& low, const Scalar& high) const {
  return copy_(clamp(low, high));
}
Tensor Tensor::clamp(const Scalar& low, const Scalar& high) const {
  return mapped(*this, [&](auto x) {
    using T = decltype(x);
    return clamped(x, low.to<T>(), high.to<T>());
  });
}
Tensor Tensor::clamp_min(const Scalar& low) const {
  return mapped(*this, [&](auto x) {
    const auto least = low.to<decltype(x)>();
    return x < least ? least : x;
  });
}
Tensor Tensor::abs() const {
  return mapped(*this, [](auto x) { return std::abs(x); });
}
Tensor Tensor::sqrt() const {
  return mapped(*this, [](auto x) { return std::sqrt(x); });
}
Tensor Tensor::floor() const {
  return mapped(*this, [](auto x) { return std::floor(x); });
}
Tensor Tensor::exp() const {
  return mapped(*this, [](auto x) { return std::exp(x); });
}
Tensor Tensor::log() const {
  return mapped(*this, [](auto x) { return std::log(x); });
}
Tensor Tensor::log1p() const {
  return mapped(*this, [](auto x) { return std::log1p(x); });
}
Tensor Tensor::sin() const {
  return mapped(*this, [](auto x) { return std::sin(x); });
}
Tensor Tensor::cos() const {
  return mapped(*this, [](auto x) { return std::cos(x); });
}
Tensor softplus(const Tensor& t) {
  return mapped(t, [](auto x) { return x > 20 ? x : std::log1p(std::exp(x)); });
}
Tensor gelu(const Tensor& t) {
  return mapped(t, [](auto x) {
    using T = decltype(x);
    return static_cast<T>(T{0.5} * x * (1 + std::erf(x * T{M_SQRT1_2})));
  });
}
Tensor pow(double base, const Tensor& exponent) {
  return mapped(exponent, [&](auto x) { return std::pow(static_cast<decltype(x)>(base), x); });
}
Tensor Tensor::isfinite() const {
  const Tensor out(sizes(), kBool);
  AT_DISPATCH_FLOATING_TYPES(scalar_type(), "isfinite", [&] {
    map_into<scalar_t, bool>(out, *this, [](scalar_t x) { return std::isfinite(x); });
  });
  return out;
}

Tensor where(const Tensor& condition, const Tensor& a, const Tensor& b) {
  check_types(a, b);
  const BroadcastShape values(a.sizes(), b.sizes());
  const BroadcastShape shape(condition.sizes(), values);
  const Tensor out = b.expand(shape).clone();
  const Tensor mask = condition.expand(shape), from = a.expand(shape);
  visit_type(a.scalar_type(), [&](auto type) {
    using T = decltype(type);
    over_runs<3>(shape, {&out, &mask, &from}, [](const auto& at, const auto& step, int64_t count) {
      auto* to = reinterpret_cast<T*>(at[0]);
      const auto* chosen = reinterpret_cast<const bool*>(at[1]);
      const auto* value = reinterpret_cast<const T*>(at[2]);
      for (int64_t i = 0; i < count; ++i)
        if (chosen[i * step[1]]) to[i * step[0]] = value[i * step[2]];
    });
  });
  return out;
}
Tensor where(const Tensor& condition, const Tensor& a, const Scalar& b) {
  return where(condition, a, like(b, a));
}
Tensor Tensor::masked_fill(const Tensor& mask, const Scalar& value) const {
  return where(mask, like(value, *this), *this);
}
Tensor addcmul(const Tensor& sum, const Tensor& a, const Tensor& b) { return sum + a * b; }

Tensor dropout(const Tensor& t, double share, bool trains) {
  TORCH_CHECK(!trains || share == 0, "this build does not train");
  return t;
}

}  // namespace lte::tensor
