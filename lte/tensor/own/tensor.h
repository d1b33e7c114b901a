// Strided arrays on the CPU with the interface of at::Tensor, as far as inference uses it. What a
// function here does, LibTorch's documentation of the same name says; what it does not do is an
// error, never another result:
//
// - Both sides of an operation have one type. Sums of float32 are made in double.
// - Views share memory, as LibTorch's do. Nothing is differentiated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "lte/tensor/own/array_ref.h"
#include "lte/tensor/own/device.h"
#include "lte/tensor/own/scalar_type.h"

namespace lte::tensor {

inline constexpr size_t kMaxDims = 6;

/// What a new tensor is like.
struct TensorOptions {
  ScalarType type = kFloat;

  TensorOptions() = default;
  TensorOptions(ScalarType t) : type(t) {}
  TensorOptions dtype(ScalarType t) const { return t; }
  TensorOptions device(const Device&) const { return *this; }
};

/// A number in the type of the tensor that it meets.
class Scalar {
 public:
  template <typename T>
  requires std::is_arithmetic_v<T> Scalar(T value)
      : real_(static_cast<double>(value)), whole_(static_cast<int64_t>(value)) {
    if constexpr (std::is_floating_point_v<T>) is_real_ = true;
  }
  bool is_real() const { return is_real_; }
  template <typename T>
  T to() const {
    if constexpr (std::is_integral_v<T>) return static_cast<T>(whole_);
    if constexpr (std::is_same_v<T, double>) return real_;
    return static_cast<T>(static_cast<float>(real_));
  }

 private:
  double real_;
  int64_t whole_;
  bool is_real_ = false;
};

class Tensor {
 public:
  Tensor() = default;
  /// Memory of its own, uninitialized.
  Tensor(IntArrayRef sizes, ScalarType type);
  /// @param data  of the first number, which the tensor keeps alive
  Tensor(std::shared_ptr<std::byte> data, IntArrayRef sizes, IntArrayRef strides, ScalarType type);

  bool defined() const { return shape_ != nullptr; }
  int64_t dim() const { return static_cast<int64_t>(shape_->dims); }
  IntArrayRef sizes() const { return {shape_->sizes.data(), shape_->dims}; }
  IntArrayRef strides() const { return {shape_->strides.data(), shape_->dims}; }
  int64_t size(int64_t axis) const { return shape_->sizes[index_of(axis)]; }
  int64_t stride(int64_t axis) const { return shape_->strides[index_of(axis)]; }
  int64_t numel() const;
  size_t element_size() const { return size_of(scalar_type()); }
  size_t nbytes() const { return static_cast<size_t>(numel()) * element_size(); }
  ScalarType scalar_type() const { return shape_->type; }
  TensorOptions options() const { return scalar_type(); }
  Device device() const { return kCPU; }
  bool is_cpu() const { return true; }
  bool is_cuda() const { return false; }
  bool is_contiguous() const;
  bool requires_grad() const { return false; }
  const Tensor& detach() const { return *this; }
  void record_stream(const Stream&) const {}

  template <typename T>
  T* data_ptr() const {
    TORCH_CHECK(type_of<T>() == scalar_type(), "expected ", type_of<T>(), ", got ", scalar_type());
    return reinterpret_cast<T*>(data_.get());
  }
  template <typename T>
  const T* const_data_ptr() const {
    return data_ptr<T>();
  }
  const void* const_data_ptr() const { return data_.get(); }
  std::byte* bytes() const { return data_.get(); }
  /// Of the one number that there is.
  template <typename T>
  T item() const {
    TORCH_CHECK(numel() == 1, "expected one number, got ", sizes());
    return visit_type(scalar_type(), [&](auto type) {
      return static_cast<T>(*reinterpret_cast<const decltype(type)*>(data_.get()));
    });
  }
  /// What is read by index.
  template <typename T, size_t N>
  struct Accessor {
    static_assert(N == 1);
    const T* data;
    int64_t stride;
    const T& operator[](int64_t i) const { return data[i * stride]; }
  };
  template <typename T, size_t N>
  Accessor<T, N> accessor() const {
    return {const_data_ptr<T>(), stride(0)};
  }

  // Views.
  Tensor operator[](int64_t index) const { return select(0, index); }
  Tensor select(int64_t axis, int64_t index) const;
  Tensor narrow(int64_t axis, int64_t begin, int64_t count) const;
  Tensor slice(int64_t axis, int64_t begin, int64_t end) const {
    return narrow(axis, begin, end - begin);
  }
  Tensor view(IntArrayRef sizes) const;
  Tensor permute(IntArrayRef axes) const;
  Tensor transpose(int64_t a, int64_t b) const;
  Tensor t() const { return transpose(0, 1); }
  Tensor unsqueeze(int64_t axis) const;
  Tensor squeeze(int64_t axis) const;
  Tensor expand(IntArrayRef sizes) const;
  Tensor expand_as(const Tensor& other) const { return expand(other.sizes()); }
  std::vector<Tensor> unbind(int64_t axis) const;
  std::vector<Tensor> split_with_sizes(IntArrayRef counts, int64_t axis = 0) const;
  std::vector<Tensor> chunk(int64_t chunks, int64_t axis) const;

  // Itself where nothing changes, else a copy.
  Tensor contiguous() const { return is_contiguous() ? *this : clone(); }
  Tensor reshape(IntArrayRef sizes) const;
  Tensor flatten(int64_t first) const;
  Tensor to(ScalarType type) const;
  Tensor to(const TensorOptions& options) const { return to(options.type); }
  Tensor to(const Device& device) const;
  Tensor to(DeviceType device) const { return to(Device(device)); }
  Tensor to(const Device& device, ScalarType type) const { return to(device).to(type); }
  Tensor cpu() const { return *this; }

  // Copies.
  Tensor clone() const;
  Tensor index_select(int64_t axis, const Tensor& rows) const;
  Tensor gather(int64_t axis, const Tensor& index) const;
  Tensor repeat(IntArrayRef times) const;
  Tensor masked_fill(const Tensor& mask, const Scalar& value) const;

  // In place.
  const Tensor& copy_(const Tensor& from) const;
  const Tensor& fill_(const Scalar& value) const;
  const Tensor& zero_() const { return fill_(0); }
  const Tensor& add_(const Tensor& other) const { return copy_(add(other)); }
  const Tensor& mul_(const Scalar& factor) const;
  const Tensor& clamp_(const Scalar& low, const Scalar& high) const;
  /// Random numbers, from manual_seed() on. `normal_` is a sum of four uniform ones.
  const Tensor& uniform_(double low, double high) const;
  const Tensor& normal_(double mean, double deviation) const;
  const Tensor& scatter_(int64_t axis, const Tensor& index, const Tensor& from) const;
  const Tensor& index_copy_(int64_t axis, const Tensor& rows, const Tensor& from) const;
  const Tensor& index_add_(int64_t axis, const Tensor& rows, const Tensor& from) const;

  // By element, of shapes that broadcast.
  Tensor add(const Tensor& other) const;
  Tensor add(const Scalar& other) const;
  Tensor sub(const Tensor& other) const;
  Tensor sub(const Tensor& other, const Scalar& factor) const { return sub(other.mul(factor)); }
  Tensor sub(const Scalar& other) const;
  Tensor mul(const Tensor& other) const;
  Tensor mul(const Scalar& other) const;
  Tensor div(const Tensor& other) const;
  Tensor div(const Scalar& other) const;
  /// @param rounding  "floor"
  Tensor div(const Scalar& other, const char* rounding) const;
  Tensor eq(const Tensor& other) const;
  Tensor eq(const Scalar& other) const;
  Tensor ne(const Tensor& other) const;
  Tensor ne(const Scalar& other) const;
  Tensor gt(const Tensor& other) const;
  Tensor gt(const Scalar& other) const;
  Tensor ge(const Scalar& other) const;
  Tensor le(const Scalar& other) const;
  Tensor logical_and(const Tensor& other) const;
  Tensor logical_not() const;
  Tensor bitwise_right_shift(int64_t bits) const;
  Tensor clamp(const Scalar& low, const Scalar& high) const;
  Tensor clamp_min(const Scalar& low) const;
  Tensor abs() const;
  Tensor square() const { return mul(*this); }
  Tensor sqrt() const;
  Tensor floor() const;
  Tensor exp() const;
  Tensor log() const;
  Tensor log1p() const;
  Tensor sin() const;
  Tensor cos() const;
  Tensor isfinite() const;

  // Over all numbers, or along an axis.
  Tensor sum() const;
  Tensor sum(int64_t axis, bool keepdim = false) const;
  Tensor mean() const;
  Tensor mean(int64_t axis, bool keepdim = false) const;
  Tensor mean(int64_t axis, bool keepdim, ScalarType type) const {
    return to(type).mean(axis, keepdim);
  }
  Tensor max() const;
  Tensor min() const;
  std::tuple<Tensor, Tensor> max(int64_t axis) const;
  std::tuple<Tensor, Tensor> min(int64_t axis) const;
  Tensor amax(int64_t axis) const { return std::get<0>(max(axis)); }
  Tensor any() const;
  Tensor any(int64_t axis) const;
  Tensor all() const;
  Tensor cumsum(int64_t axis) const;
  /// [n, dim] int64
  Tensor nonzero() const;
  /// @param reduce  "amax" or "amin"
  Tensor scatter_reduce(int64_t axis, const Tensor& index, const Tensor& from,
                        const char* reduce) const;

 private:
  struct Shape {
    ScalarType type;
    size_t dims = 0;
    std::array<int64_t, kMaxDims> sizes{}, strides{};
  };
  /// −1 is the last axis.
  size_t index_of(int64_t axis) const;
  /// The same numbers from `offset` elements on.
  Tensor view_at(int64_t offset, const Shape& shape) const;

  std::shared_ptr<std::byte> data_;
  std::shared_ptr<const Shape> shape_;
};

using TensorList = ArrayRef<Tensor>;

inline Tensor operator+(const Tensor& a, const Tensor& b) { return a.add(b); }
inline Tensor operator+(const Tensor& a, const Scalar& b) { return a.add(b); }
inline Tensor operator-(const Tensor& a, const Tensor& b) { return a.sub(b); }
inline Tensor operator-(const Tensor& a, const Scalar& b) { return a.sub(b); }
inline Tensor operator*(const Tensor& a, const Tensor& b) { return a.mul(b); }
inline Tensor operator*(const Tensor& a, const Scalar& b) { return a.mul(b); }
inline Tensor operator/(const Tensor& a, const Tensor& b) { return a.div(b); }
Tensor operator-(const Scalar& a, const Tensor& b);
inline Tensor operator>(const Tensor& a, const Tensor& b) { return a.gt(b); }
inline Tensor operator>(const Tensor& a, const Scalar& b) { return a.gt(b); }
inline Tensor operator<=(const Tensor& a, const Scalar& b) { return a.le(b); }
inline Tensor operator>=(const Tensor& a, const Scalar& b) { return a.ge(b); }

}  // namespace lte::tensor

// The sources of lte name LibTorch's namespaces.
namespace lte {
namespace at = tensor;
namespace c10 = tensor;
namespace torch = tensor;
}  // namespace lte
