// Modules with the interface of those of LibTorch, as far as inference uses it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lte/tensor/own/functions.h"

namespace lte::tensor::nn {

/// Tensors in the order in which they were registered.
class NamedTensors {
 public:
  class Item {
   public:
    Item(std::string name, Tensor tensor) : name_(std::move(name)), tensor_(std::move(tensor)) {}
    const std::string& key() const { return name_; }
    const Tensor& value() const { return tensor_; }

   private:
    std::string name_;
    Tensor tensor_;
  };

  void add(const std::string& name, const Tensor& tensor) { items_.emplace_back(name, tensor); }
  bool contains(const std::string& name) const {
    return std::any_of(begin(), end(), [&](const Item& item) { return item.key() == name; });
  }
  const Tensor& operator[](const std::string& name) const;
  std::vector<Item>::const_iterator begin() const { return items_.begin(); }
  std::vector<Item>::const_iterator end() const { return items_.end(); }

 private:
  std::vector<Item> items_;
};

class Module {
 public:
  virtual ~Module() = default;

  NamedTensors named_parameters() const;
  std::vector<Tensor> parameters() const;
  std::vector<std::shared_ptr<Module>> modules(bool include_self) const;
  template <typename T>
  T* as() {
    return dynamic_cast<T*>(this);
  }
  bool is_training() const { return false; }
  void eval() {}
  void train(bool on);
  void to(const Device& device);

 protected:
  const Tensor& register_parameter(const std::string& name, const Tensor& value);
  template <typename Holder>
  Holder register_module(const std::string& name, const Holder& holder) {
    children_.emplace_back(name, holder.ptr());
    return holder;
  }

 private:
  void add_parameters(const std::string& prefix, NamedTensors* all) const;

  std::vector<std::pair<std::string, Tensor>> parameters_;
  std::vector<std::pair<std::string, std::shared_ptr<Module>>> children_;
};

/// Shares a module; made from the arguments of its constructor.
template <typename Impl>
class ModuleHolder {
 public:
  ModuleHolder(std::nullptr_t) {}
  template <typename First, typename... Rest>
  requires(
      !std::is_base_of_v<ModuleHolder, std::decay_t<First>> &&
      !std::is_same_v<std::nullptr_t, std::decay_t<First>>) explicit ModuleHolder(First&& first,
                                                                                  Rest&&... rest)
      : impl_(std::make_shared<Impl>(std::forward<First>(first), std::forward<Rest>(rest)...)) {}

  Impl* operator->() const { return impl_.get(); }
  Impl& operator*() const { return *impl_; }
  const std::shared_ptr<Impl>& ptr() const { return impl_; }
  explicit operator bool() const { return impl_ != nullptr; }

 private:
  std::shared_ptr<Impl> impl_;
};

struct LinearOptions {
  int64_t inputs, outputs;

  int64_t in_features() const { return inputs; }
  int64_t out_features() const { return outputs; }
};

class LinearImpl : public Module {
 public:
  LinearImpl(int64_t inputs, int64_t outputs);

  LinearOptions options;
  Tensor weight, bias;
};

struct LayerNormOptions {
  explicit LayerNormOptions(std::vector<int64_t> of) : shape(std::move(of)) {}
  LayerNormOptions& eps(double value) {
    epsilon = value;
    return *this;
  }
  double eps() const { return epsilon; }

  std::vector<int64_t> shape;
  double epsilon = 1e-5;
};

class LayerNormImpl : public Module {
 public:
  explicit LayerNormImpl(const LayerNormOptions& of);

  LayerNormOptions options;
  Tensor weight, bias;
};

namespace init {
inline void normal_(const Tensor& t, double mean, double deviation) { t.normal_(mean, deviation); }
inline void uniform_(const Tensor& t, double low, double high) { t.uniform_(low, high); }
}  // namespace init

}  // namespace lte::tensor::nn

#define TORCH_MODULE(Name)                                           \
  class Name : public ::lte::tensor::nn::ModuleHolder<Name##Impl> {  \
   public:                                                           \
    using ::lte::tensor::nn::ModuleHolder<Name##Impl>::ModuleHolder; \
  }
