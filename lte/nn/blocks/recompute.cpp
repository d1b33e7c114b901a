#include "lte/nn/blocks/recompute.h"

#include <utility>

#include <ATen/autocast_mode.h>
#include <c10/core/GradMode.h>
#include <torch/csrc/autograd/autograd.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/custom_class.h>

namespace lte::nn {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// Casting of the forward pass: the second run must compute the same.
struct Autocast {
  at::DeviceType device;
  bool enabled;
  at::ScalarType dtype;

  explicit Autocast(at::DeviceType type)
      : device(type),
        enabled(at::autocast::is_autocast_enabled(type)),
        dtype(at::autocast::get_autocast_dtype(type)) {}
  void set() const {
    at::autocast::set_autocast_enabled(device, enabled);
    at::autocast::set_autocast_dtype(device, dtype);
  }
};

class AutocastScope {
 public:
  explicit AutocastScope(const Autocast& wanted) : before_(wanted.device) { wanted.set(); }
  ~AutocastScope() { before_.set(); }
  AutocastScope(const AutocastScope&) = delete;
  AutocastScope& operator=(const AutocastScope&) = delete;

 private:
  Autocast before_;
};

thread_local bool first_run = false;

class FirstRun {
 public:
  FirstRun() : before_(first_run) { first_run = true; }
  ~FirstRun() { first_run = before_; }
  FirstRun(const FirstRun&) = delete;
  FirstRun& operator=(const FirstRun&) = delete;

 private:
  bool before_;
};

struct Call : torch::CustomClassHolder {
  TensorFunction function;
  std::vector<at::Tensor> parameters;
  Autocast autocast;

  Call(TensorFunction f, std::vector<at::Tensor> p, at::DeviceType device)
      : function(std::move(f)), parameters(std::move(p)), autocast(device) {}
};

class Recompute : public torch::autograd::Function<Recompute> {
 public:
  // The parameters are arguments so that the graph leads to them; the function reads them itself.
  static variable_list forward(AutogradContext* context, const c10::intrusive_ptr<Call>& call,
                               at::TensorList inputs, at::TensorList parameters) {
    static_cast<void>(parameters);
    context->saved_data["call"] = c10::IValue::make_capsule(call);
    context->save_for_backward(inputs.vec());
    const FirstRun run;
    return call->function(inputs.vec());
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const auto holder = context->saved_data["call"].toCapsule();
    const auto& call = static_cast<const Call&>(*holder);
    const variable_list saved = context->get_saved_variables();
    variable_list inputs, wanted;
    std::vector<size_t> place;  // of the results' gradients among ours
    for (size_t i = 0; i < saved.size(); ++i) {
      inputs.push_back(saved[i].detach());
      if (!context->needs_input_grad(i)) continue;
      inputs.back().requires_grad_();
      wanted.push_back(inputs.back());
      place.push_back(1 + i);
    }
    for (size_t i = 0; i < call.parameters.size(); ++i) {
      if (!context->needs_input_grad(saved.size() + i)) continue;
      wanted.push_back(call.parameters[i]);
      place.push_back(1 + saved.size() + i);
    }
    variable_list outputs, output_grads;
    {
      const c10::AutoGradMode with_gradients(true);
      const AutocastScope autocast(call.autocast);
      const variable_list results = call.function(inputs);
      for (size_t i = 0; i < results.size(); ++i) {
        if (!grads[i].defined() || !results[i].requires_grad()) continue;
        outputs.push_back(results[i]);
        output_grads.push_back(grads[i]);
      }
    }
    variable_list out(1 + saved.size() + call.parameters.size());
    if (outputs.empty() || wanted.empty()) return out;
    const variable_list found = torch::autograd::grad(
        outputs, wanted, output_grads, /*retain_graph=*/false, /*create_graph=*/false,
        /*allow_unused=*/true);
    for (size_t i = 0; i < found.size(); ++i) out[place[i]] = found[i];
    return out;
  }
};

}  // namespace

bool is_differentiated() { return c10::GradMode::is_enabled() || first_run; }

std::vector<at::Tensor> recompute(TensorFunction function, const std::vector<at::Tensor>& inputs,
                                  const std::vector<at::Tensor>& parameters) {
  if (!c10::GradMode::is_enabled()) return function(inputs);
  const auto call =
      c10::make_intrusive<Call>(std::move(function), parameters, inputs.at(0).device().type());
  return Recompute::apply(call, at::TensorList(inputs), at::TensorList(parameters));
}

}  // namespace lte::nn
