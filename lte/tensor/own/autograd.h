// Functions that LibTorch differentiates, forward alone. Their backward() compiles and is never
// run: what it would read was not kept.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "lte/tensor/own/tensor.h"

namespace lte::tensor {

struct CustomClassHolder {
  virtual ~CustomClassHolder() = default;
};
template <typename T>
using intrusive_ptr = std::shared_ptr<T>;
template <typename T>
std::shared_ptr<T> make_intrusive() {
  return std::make_shared<T>();
}

/// What a node would keep beside tensors.
struct IValue {
  template <typename T>
  IValue& operator=(const T&) {
    return *this;
  }
  bool toBool() const { return false; }
  int64_t toInt() const { return 0; }
  std::vector<int64_t> toIntVector() const { return {}; }
  std::shared_ptr<CustomClassHolder> toCapsule() const { return nullptr; }
  template <typename T>
  static IValue make_capsule(const T&) {
    return {};
  }
};

struct AutoDispatchBelowADInplaceOrView {
  AutoDispatchBelowADInplaceOrView() {}
};

namespace autograd {

using variable_list = std::vector<Tensor>;

struct AutogradContext {
  struct Nothing {
    IValue operator[](const char*) const { return {}; }
  } saved_data;
  void save_for_backward(const variable_list&) {}
  variable_list get_saved_variables() const { return {}; }
  bool needs_input_grad(size_t) const { return false; }
};

template <typename Derived>
struct Function {
  template <typename... Args>
  static auto apply(Args&&... args) {
    AutogradContext context;
    return Derived::forward(&context, std::forward<Args>(args)...);
  }
};

}  // namespace autograd
}  // namespace lte::tensor
