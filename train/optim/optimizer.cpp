#include "train/optim/optimizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#include <ATen/ops/_foreach_add.h>
#include <ATen/ops/_foreach_lerp.h>
#include <ATen/ops/_foreach_mul.h>
#include <ATen/ops/_foreach_norm.h>
#include <ATen/ops/_fused_adamw.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/lerp.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/tensor.h>
#include <ATen/ops/zeros.h>
#include <ATen/ops/zeros_like.h>

#include "lte/base/check.h"
#include "lte/nn/files/tensor_io.h"
#include "lte/ops/orthogonal.h"
#include "train/optim/schedule.h"

namespace lte::train {
std::string gradient_module(const std::string& parameter) {
  constexpr std::string_view kEncoder = "encoder.";
  if (!parameter.starts_with(kEncoder)) return parameter.substr(0, parameter.find('.'));
  std::string part = parameter.substr(kEncoder.size());
  part = part.substr(0, part.find('.'));
  if (part == "stem_norm") part = "stem";
  if (part.starts_with("unpool")) part = "up" + part.substr(std::strlen("unpool"));
  if (part.starts_with("pool")) part = "down" + part.substr(std::strlen("pool"));
  return "encoder_" + part;
}

namespace {

/// Root mean square of an entry of Muon's update at a rate of 1, about that of AdamW's.
constexpr double kUpdateRms = 0.2;
/// Momentum of Muon's gradient, and AdamW's decays of the first and the second moment.
constexpr double kMuonMomentum = 0.95, kBeta1 = 0.9, kBeta2 = 0.999;
/// Layers of fewer inputs or outputs, which read offsets or write an answer, are AdamW's.
constexpr int64_t kMinSide = 16;

/// [B, N, M] of a layer's weights: queries, keys and values apart, a convolution's taps together.
at::Tensor matrices_of(const std::string& name, const at::Tensor& weights) {
  if (weights.dim() == 3) return weights.reshape({1, -1, weights.size(2)});
  if (name.ends_with("qkv.weight")) return weights.reshape({3, -1, weights.size(1)});
  return weights.unsqueeze(0);
}

}  // namespace

bool uses_muon(const OptimConfig& config, const std::string& parameter, const at::Tensor& weights) {
  if (config.optimizer != OptimizerKind::Muon || weights.dim() < 2) return false;
  const at::Tensor matrices = matrices_of(parameter, weights.detach());
  return std::min(matrices.size(1), matrices.size(2)) >= kMinSide;
}

Optimizer::Optimizer(const OptimConfig& config, const nn::LightTransportModel& model)
    : config_(config) {
  for (const auto& item : model->named_parameters()) {
    const at::Tensor& parameter = item.value();
    names_.push_back(item.key());
    parameters_.push_back(parameter);
    rate_factors_.push_back(rate_factor(config, item.key()));
    first_moments_.push_back(at::zeros_like(parameter.detach()));
    by_muon_.push_back(uses_muon(config, item.key(), parameter));
    second_moments_.push_back(by_muon_.back() ? at::Tensor() : at::zeros_like(parameter.detach()));
    updates_.push_back(at::zeros({}, parameter.options().requires_grad(false)));
    if (config_.ema_decay > 0) average_.push_back(parameter.detach().clone());
  }
}

void Optimizer::zero_gradients() {
  for (at::Tensor& parameter : parameters_) parameter.mutable_grad().reset();
}

std::vector<at::Tensor> Optimizer::gradients() const {
  std::vector<at::Tensor> gradients;
  for (const at::Tensor& parameter : parameters_) {
    if (parameter.grad().defined()) gradients.push_back(parameter.grad());
  }
  return gradients;
}

double Optimizer::gradient_norm() const {
  const torch::NoGradGuard no_grad;
  const std::vector<at::Tensor> all = gradients();
  if (all.empty()) return 0;
  return at::stack(at::_foreach_norm(all)).to(at::kDouble).norm().item<double>();
}

std::vector<std::pair<std::string, double>> Optimizer::module_norms() const {
  const torch::NoGradGuard no_grad;
  const std::vector<at::Tensor> all = gradients();
  at::Tensor norms;  // of each parameter with a gradient, in one copy from the device
  if (!all.empty()) norms = at::stack(at::_foreach_norm(all)).to(at::kCPU, at::kDouble);
  std::vector<std::pair<std::string, double>> modules;
  int64_t next = 0;
  for (size_t i = 0; i < names_.size(); ++i) {
    const std::string module = gradient_module(names_[i]);
    auto found = std::find_if(modules.begin(), modules.end(),
                              [&](const auto& entry) { return entry.first == module; });
    if (found == modules.end()) found = modules.insert(found, {module, 0.0});
    if (!parameters_[i].grad().defined()) continue;
    const double norm = norms.const_data_ptr<double>()[next++];
    found->second += norm * norm;
  }
  for (auto& [module, value] : modules) value = std::sqrt(value);
  return modules;
}

std::vector<std::pair<std::string, double>> Optimizer::module_rms() const {
  std::vector<std::pair<std::string, double>> modules = module_norms();
  for (auto& [module, value] : modules) {
    int64_t numbers = 0;
    for (size_t i = 0; i < names_.size(); ++i) {
      if (gradient_module(names_[i]) == module) numbers += parameters_[i].numel();
    }
    value /= std::sqrt(static_cast<double>(numbers));
  }
  return modules;
}

void Optimizer::update(int64_t step, double norm, std::optional<double> given_rate) {
  const torch::NoGradGuard no_grad;
  if (config_.clip_norm > 0 && norm > config_.clip_norm) {
    at::_foreach_mul_(gradients(), config_.clip_norm / norm);
  }
  const double rate = given_rate ? *given_rate : learning_rate(config_, step);
  // Biases and norms do not decay.
  const std::set<double> factors(rate_factors_.begin(), rate_factors_.end());
  for (const double factor : factors) {
    for (const bool matrices : {true, false}) update_group(factor, matrices, factor * rate);
    if (factor > 0) update_orthogonal(factor, factor * rate);
  }
  if (average_.empty()) return;
  at::_foreach_lerp_(average_, parameters_, 1 - ema_decay(config_, step));
}

/// Updates the parameters of one rate factor that are matrices, or that are not.
void Optimizer::update_group(double factor, bool matrices, double rate) {
  if (factor == 0) return;
  std::vector<at::Tensor> weights, gradients, first, second, updates;
  for (size_t i = 0; i < parameters_.size(); ++i) {
    if (!parameters_[i].grad().defined() || (parameters_[i].dim() >= 2) != matrices ||
        rate_factors_[i] != factor || by_muon_[i])
      continue;
    weights.push_back(parameters_[i]);
    gradients.push_back(parameters_[i].grad());
    first.push_back(first_moments_[i]);
    second.push_back(second_moments_[i]);
    updates.push_back(updates_[i]);
  }
  if (weights.empty()) return;
  at::_foreach_add_(updates, 1);
  at::_fused_adamw_(weights, gradients, first, second, {}, updates, rate, kBeta1, kBeta2,
                    matrices ? config_.weight_decay : 0, config_.adam_epsilon,
                    /*amsgrad=*/false, /*maximize=*/false);
}

/// Updates the matrices of one rate factor that Muon moves, those of one shape together.
void Optimizer::update_orthogonal(double factor, double rate) {
  std::vector<size_t> moved;  // indices of the parameters
  std::vector<at::Tensor> weights, gradients, moments, counts;
  for (size_t i = 0; i < parameters_.size(); ++i) {
    if (!by_muon_[i] || rate_factors_[i] != factor || !parameters_[i].grad().defined()) continue;
    moved.push_back(i);
    weights.push_back(parameters_[i]);
    gradients.push_back(parameters_[i].grad());
    moments.push_back(first_moments_[i]);
    counts.push_back(updates_[i]);
  }
  if (moved.empty()) return;
  at::_foreach_lerp_(moments, gradients, 1 - kMuonMomentum);
  std::vector<at::Tensor> steps = at::_foreach_lerp(gradients, moments, kMuonMomentum);
  std::map<std::pair<int64_t, int64_t>, std::vector<size_t>> shapes;  // places in `moved`
  for (size_t k = 0; k < moved.size(); ++k) {
    steps[k] = matrices_of(names_[moved[k]], steps[k]);
    shapes[{steps[k].size(1), steps[k].size(2)}].push_back(k);
  }
  at::_foreach_mul_(weights, 1 - rate * config_.weight_decay);
  for (const auto& [shape, members] : shapes) {
    std::vector<at::Tensor> stack, targets;
    std::vector<int64_t> matrices;
    for (const size_t k : members) {
      stack.push_back(steps[k]);
      matrices.push_back(steps[k].size(0));
      targets.push_back(weights[k]);
    }
    // Orthogonal matrices have entries of the root of 1 / the longer side (Liu et al. 2025).
    const double length =
        kUpdateRms * std::sqrt(static_cast<double>(std::max(shape.first, shape.second)));
    std::vector<at::Tensor> turned = ops::orthogonal(at::cat(stack)).split_with_sizes(matrices);
    for (size_t k = 0; k < members.size(); ++k) turned[k] = turned[k].reshape(targets[k].sizes());
    at::_foreach_add_(targets, turned, -rate * length);
  }
  at::_foreach_add_(counts, 1);
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
  std::vector<int64_t> updates;
  for (size_t i = 0; i < names_.size(); ++i) {
    updates.push_back(updates_[i].item<int64_t>());
    tensors["exp_avg." + names_[i]] = first_moments_[i];
    if (!by_muon_[i]) tensors["exp_avg_sq." + names_[i]] = second_moments_[i];
    if (has_average()) tensors["average." + names_[i]] = average_[i];
  }
  tensors["updates"] = at::tensor(updates, at::kLong);
  return tensors;
}

void Optimizer::load_state(const SafetensorsFile& file) {
  const torch::NoGradGuard no_grad;
  const auto updates = file.values<int64_t>("updates", {static_cast<int64_t>(names_.size())});
  for (size_t i = 0; i < names_.size(); ++i) {
    if (has_average() && file.contains("average." + names_[i])) {
      nn::read_tensor(file, "average." + names_[i], average_[i]);
    } else if (has_average()) {
      average_[i].copy_(parameters_[i]);  // averaging was switched on for the resumed part
    }
    updates_[i].fill_(updates[i]);
    if (updates[i] == 0) continue;  // files of earlier versions have no moments then
    nn::read_tensor(file, "exp_avg." + names_[i], first_moments_[i]);
    if (by_muon_[i]) continue;
    const std::string second = "exp_avg_sq." + names_[i];
    LTE_CHECK(file.contains(second), file.path().string(), ": has no tensor \"", second,
              "\": a run with train.optimizer: muon cannot go on with adamw (--init-weights takes "
              "its weights)");
    nn::read_tensor(file, second, second_moments_[i]);
  }
}

}  // namespace lte::train
