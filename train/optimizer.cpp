#include "train/optimizer.h"

#include <cmath>
#include <utility>

#include <ATen/ops/_foreach_mul.h>
#include <ATen/ops/_foreach_norm.h>
#include <ATen/ops/lerp.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/tensor.h>
#include <torch/optim/adamw.h>

#include "train/schedule.h"
#include "train/tensor_io.h"

namespace lte::train {
namespace {

using torch::optim::AdamWOptions;
using torch::optim::AdamWParamState;
using torch::optim::OptimizerParamGroup;

std::unique_ptr<torch::optim::AdamW> make_adam(const OptimConfig& config,
                                               const std::vector<at::Tensor>& parameters) {
  std::vector<at::Tensor> decayed, plain;
  for (const at::Tensor& parameter : parameters)
    (parameter.dim() >= 2 ? decayed : plain).push_back(parameter);
  AdamWOptions options(config.learning_rate);
  options.betas({config.beta1, config.beta2}).weight_decay(config.weight_decay);
  AdamWOptions plain_options = options;
  plain_options.weight_decay(0);
  std::vector<OptimizerParamGroup> groups;
  groups.emplace_back(decayed, std::make_unique<AdamWOptions>(options));
  groups.emplace_back(plain, std::make_unique<AdamWOptions>(plain_options));
  return std::make_unique<torch::optim::AdamW>(groups, options);
}

}  // namespace

Optimizer::Optimizer(const OptimConfig& config, const nn::LightTransportModel& model)
    : config_(config) {
  for (const auto& item : model->named_parameters()) {
    names_.push_back(item.key());
    parameters_.push_back(item.value());
  }
  if (config_.ema_decay > 0) {
    for (const at::Tensor& parameter : parameters_) average_.push_back(parameter.detach().clone());
  }
  adam_ = make_adam(config_, parameters_);
}

Optimizer::~Optimizer() = default;

void Optimizer::zero_gradients() { adam_->zero_grad(); }

double Optimizer::gradient_norm() const {
  const torch::NoGradGuard no_grad;
  std::vector<at::Tensor> gradients;
  for (const at::Tensor& parameter : parameters_) {
    if (parameter.grad().defined()) gradients.push_back(parameter.grad());
  }
  if (gradients.empty()) return 0;
  return at::stack(at::_foreach_norm(gradients)).to(at::kDouble).norm().item<double>();
}

void Optimizer::update(int64_t step, double norm) {
  const torch::NoGradGuard no_grad;
  if (config_.clip_norm > 0 && norm > config_.clip_norm) {
    std::vector<at::Tensor> gradients;
    for (const at::Tensor& parameter : parameters_) {
      if (parameter.grad().defined()) gradients.push_back(parameter.grad());
    }
    at::_foreach_mul_(gradients, config_.clip_norm / norm);
  }
  for (auto& group : adam_->param_groups()) group.options().set_lr(learning_rate(config_, step));
  adam_->step();
  if (average_.empty()) return;
  const double weight = 1 - ema_decay(config_, step);
  for (size_t i = 0; i < average_.size(); ++i) average_[i].lerp_(parameters_[i], weight);
}

void Optimizer::swap_average() {
  for (size_t i = 0; i < average_.size(); ++i) {
    at::Tensor weights = parameters_[i].variable_data();
    parameters_[i].set_data(average_[i]);
    average_[i] = std::move(weights);
  }
}

std::map<std::string, at::Tensor> Optimizer::state() const {
  std::map<std::string, at::Tensor> tensors;
  std::vector<int64_t> updates(names_.size(), 0);
  for (size_t i = 0; i < names_.size(); ++i) {
    const auto found = adam_->state().find(parameters_[i].unsafeGetTensorImpl());
    if (found != adam_->state().end()) {
      const auto& moments = static_cast<const AdamWParamState&>(*found->second);
      updates[i] = moments.step();
      tensors["exp_avg." + names_[i]] = moments.exp_avg();
      tensors["exp_avg_sq." + names_[i]] = moments.exp_avg_sq();
    }
    if (has_average()) tensors["average." + names_[i]] = average_[i];
  }
  tensors["updates"] = at::tensor(updates, at::kLong);
  return tensors;
}

void Optimizer::load_state(const SafetensorsFile& file) {
  const torch::NoGradGuard no_grad;
  const auto updates = file.values<int64_t>("updates", {static_cast<int64_t>(names_.size())});
  for (size_t i = 0; i < names_.size(); ++i) {
    const at::Tensor& parameter = parameters_[i];
    if (has_average() && file.contains("average." + names_[i])) {
      read_tensor(file, "average." + names_[i], average_[i]);
    } else if (has_average()) {
      average_[i].copy_(parameter);  // averaging was switched on for the resumed part
    }
    if (updates[i] == 0) continue;  // never had a gradient, so no moments yet
    auto moments = std::make_unique<AdamWParamState>();
    moments->step(updates[i]);
    moments->exp_avg(at::empty_like(parameter));
    moments->exp_avg_sq(at::empty_like(parameter));
    read_tensor(file, "exp_avg." + names_[i], moments->exp_avg());
    read_tensor(file, "exp_avg_sq." + names_[i], moments->exp_avg_sq());
    adam_->state()[parameter.unsafeGetTensorImpl()] = std::move(moments);
  }
}

}  // namespace lte::train
