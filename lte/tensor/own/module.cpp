#include "lte/tensor/own/module.h"

namespace lte::tensor::nn {

const Tensor& NamedTensors::operator[](const std::string& name) const {
  const auto found =
      std::find_if(begin(), end(), [&](const Item& item) { return item.key() == name; });
  TORCH_CHECK(found != end(), "there is no tensor ", name);
  return found->value();
}

const Tensor& Module::register_parameter(const std::string& name, const Tensor& value) {
  return parameters_.emplace_back(name, value).second;
}

void Module::add_parameters(const std::string& prefix, NamedTensors* all) const {
  for (const auto& [name, tensor] : parameters_) all->add(prefix + name, tensor);
  for (const auto& [name, child] : children_) child->add_parameters(prefix + name + '.', all);
}

NamedTensors Module::named_parameters() const {
  NamedTensors all;
  add_parameters("", &all);
  return all;
}

std::vector<Tensor> Module::parameters() const {
  std::vector<Tensor> all;
  for (const auto& item : named_parameters()) all.push_back(item.value());
  return all;
}

std::vector<std::shared_ptr<Module>> Module::modules(bool include_self) const {
  TORCH_CHECK(!include_self, "a module among its own");
  std::vector<std::shared_ptr<Module>> all;
  for (const auto& [name, child] : children_) {
    all.push_back(child);
    const auto below = child->modules(false);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

void Module::train(bool on) { TORCH_CHECK(!on, "this build does not train"); }

void Module::to(const Device& device) {
  TORCH_CHECK(device.is_cpu(), "this build computes on the CPU alone");
}

LinearImpl::LinearImpl(int64_t inputs, int64_t outputs)
    : options{inputs, outputs},
      weight(register_parameter("weight", zeros({outputs, inputs}))),
      bias(register_parameter("bias", zeros({outputs}))) {}

LayerNormImpl::LayerNormImpl(const LayerNormOptions& of)
    : options(of),
      weight(register_parameter("weight", ones(of.shape))),
      bias(register_parameter("bias", zeros(of.shape))) {}

}  // namespace lte::tensor::nn
