// Functions of tensors with the interface of those of the same names in LibTorch.
#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>
#include <vector>

#include "lte/tensor/own/tensor.h"

namespace lte::tensor {

Tensor empty(IntArrayRef sizes, const TensorOptions& options = {});
Tensor empty_strided(IntArrayRef sizes, IntArrayRef strides, const TensorOptions& options);
Tensor empty_like(const Tensor& like);
Tensor full(IntArrayRef sizes, const Scalar& value, const TensorOptions& options = {});
inline Tensor zeros(IntArrayRef sizes, const TensorOptions& options = {}) {
  return full(sizes, 0, options);
}
inline Tensor ones(IntArrayRef sizes, const TensorOptions& options = {}) {
  return full(sizes, 1, options);
}
inline Tensor zeros_like(const Tensor& like) { return zeros(like.sizes(), like.options()); }
inline Tensor ones_like(const Tensor& like) { return ones(like.sizes(), like.options()); }
Tensor arange(int64_t begin, int64_t end, const TensorOptions& options = kLong);
inline Tensor arange(int64_t end, const TensorOptions& options = kLong) {
  return arange(0, end, options);
}
/// Borrows the memory.
Tensor from_blob(void* data, IntArrayRef sizes, const TensorOptions& options);
Tensor from_blob(void* data, IntArrayRef sizes, IntArrayRef strides, const TensorOptions& options);

template <typename T>
Tensor tensor(ArrayRef<T> values, const TensorOptions& options) {
  Tensor own({static_cast<int64_t>(values.size())}, type_of<T>());
  std::copy(values.begin(), values.end(), own.data_ptr<T>());
  return own.to(options);
}
template <typename T>
Tensor tensor(std::initializer_list<T> values, const TensorOptions& options) {
  return tensor(ArrayRef<T>(values), options);
}
template <typename T>
Tensor tensor(const std::vector<T>& values, const TensorOptions& options) {
  return tensor(ArrayRef<T>(values), options);
}

void manual_seed(uint64_t seed);

Tensor cat(TensorList tensors, int64_t axis = 0);
Tensor stack(TensorList tensors, int64_t axis = 0);
Tensor constant_pad_nd(const Tensor& t, IntArrayRef pad);
Tensor repeat_interleave(const Tensor& times);

Tensor where(const Tensor& condition, const Tensor& a, const Tensor& b);
Tensor where(const Tensor& condition, const Tensor& a, const Scalar& b);
Tensor pow(double base, const Tensor& exponent);
Tensor addcmul(const Tensor& sum, const Tensor& a, const Tensor& b);
Tensor softplus(const Tensor& t);
Tensor gelu(const Tensor& t);
inline Tensor log1p(const Tensor& t) { return t.log1p(); }
inline Tensor isfinite(const Tensor& t) { return t.isfinite(); }
inline Tensor amax(const Tensor& t, IntArrayRef axis) { return t.amax(axis[0]); }
/// Only training drops out.
Tensor dropout(const Tensor& t, double share, bool trains);

std::tuple<Tensor, Tensor> sort(const Tensor& t, bool stable, int64_t axis, bool descending);
/// @return  the numbers, which of them each row is, and how often each comes
std::tuple<Tensor, Tensor, Tensor> unique_consecutive(const Tensor& sorted, bool return_inverse,
                                                      bool return_counts);
Tensor bincount(const Tensor& t, const Tensor& weights, int64_t least);

Tensor bmm(const Tensor& a, const Tensor& b);
Tensor baddbmm(const Tensor& sum, const Tensor& a, const Tensor& b);
Tensor mv(const Tensor& a, const Tensor& x);
void mm_out(const Tensor& out, const Tensor& a, const Tensor& b);
void addmm_out(const Tensor& out, const Tensor& sum, const Tensor& a, const Tensor& b);
Tensor linear(const Tensor& x, const Tensor& weight, const std::optional<Tensor>& bias);
Tensor layer_norm(const Tensor& x, IntArrayRef shape, const Tensor& gain, const Tensor& bias,
                  double epsilon);
Tensor softmax(const Tensor& t, int64_t axis);
Tensor log_softmax(const Tensor& t, int64_t axis);
Tensor scaled_dot_product_attention(const Tensor& query, const Tensor& key, const Tensor& value);

/// Settings of LibTorch that only GPUs have.
struct Context {
  bool userEnabledCuDNNSDP() const { return false; }
  void setSDPUseCuDNN(bool) const {}
};
inline Context globalContext() { return {}; }

}  // namespace lte::tensor

/// Runs a function of no arguments in which `scalar_t` is the type, float32 or float64.
#define AT_DISPATCH_FLOATING_TYPES(type, name, ...)                                        \
  do {                                                                                     \
    TORCH_CHECK((type) == ::lte::tensor::kFloat || (type) == ::lte::tensor::kDouble, name, \
                ": expected Float or Double, got ", type);                                 \
    if ((type) == ::lte::tensor::kFloat) {                                                 \
      using scalar_t = float;                                                              \
      __VA_ARGS__();                                                                       \
    } else {                                                                               \
      using scalar_t = double;                                                             \
      __VA_ARGS__();                                                                       \
    }                                                                                      \
  } while (false)
