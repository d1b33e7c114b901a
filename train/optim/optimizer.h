// The weight update: AdamW, and Muon for matrices where it is asked for, with clipping of the
// gradient's norm and an optional moving average of the weights.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lte/base/safetensors.h"
#include "lte/nn/model.h"
#include "train/config.h"

namespace lte::train {

/// The module that a parameter counts to: nne, encoder_stem, encoder_downS and encoder_upS (stage S
/// with the pooling or unpooling into it), encoder_norm or decoder. For other names it is what
/// stands before the first dot.
std::string gradient_module(const std::string& parameter);

/// Whether Muon moves a parameter, which then has one moment: a matrix between features, or a
/// convolution's. What reads offsets or writes an answer, biases and norms are AdamW's.
bool uses_muon(const OptimConfig& config, const std::string& parameter, const at::Tensor& weights);

class Optimizer {
 public:
  /// Each parameter's rate is the schedule's times its rate_factor(); with 0 it is frozen.
  /// Weight decay applies to parameters of two dimensions or more; biases and norms are left alone.
  /// The averaged weights start as the model's present ones.
  Optimizer(const OptimConfig& config, const nn::LightTransportModel& model);
  Optimizer(const Optimizer&) = delete;
  Optimizer& operator=(const Optimizer&) = delete;

  void zero_gradients();
  /// L2 norm of the whole gradient; not finite if any entry is not.
  double gradient_norm() const;
  /// L2 norm of the gradient of each module (gradient_module()), in the order of the model. Their
  /// squares sum to that of gradient_norm(). A module whose parameters have no gradient has 0.
  std::vector<std::pair<std::string, double>> module_norms() const;
  /// Root mean square of an entry of each module's gradient: module_norms() over the root of its
  /// number of parameters. Far below `adam_epsilon` they stand still.
  std::vector<std::pair<std::string, double>> module_rms() const;
  /// Scales the gradient down to clip_norm if `norm` exceeds it, then updates weights and their
  /// average.
  /// @param step  steps done before this one: it decides learning rate and averaging rate
  /// @param rate  a learning rate in place of the schedule's
  void update(int64_t step, double norm, std::optional<double> rate = std::nullopt);

  bool has_average() const { return !average_.empty(); }
  /// Exchanges the model's weights and their average, without copying. No-op without an average.
  void swap_average();

  /// Everything that the next update depends on: "exp_avg.NAME", "exp_avg_sq.NAME" (not of what
  /// Muon moves), "average.NAME", and "updates", the number of updates of each parameter, [P] int64
  /// in the model's order.
  std::map<std::string, at::Tensor> state() const;
  /// @throws lte::Error naming file and tensor if one is missing or of another shape.
  void load_state(const SafetensorsFile& file);

 private:
  void update_group(double factor, bool matrices, double rate);
  void update_orthogonal(double factor, double rate);
  /// The gradients of the parameters that have one.
  std::vector<at::Tensor> gradients() const;

  OptimConfig config_;
  std::vector<std::string> names_;
  std::vector<at::Tensor> parameters_;
  std::vector<double> rate_factors_;
  std::vector<bool> by_muon_;
  std::vector<at::Tensor> first_moments_, second_moments_;
  std::vector<at::Tensor> updates_;  ///< number of each parameter, float32 [] for the fused kernel
  std::vector<at::Tensor> average_;  ///< empty without averaging
};

/// Exchanges weights and average while it lives.
class AverageScope {
 public:
  explicit AverageScope(Optimizer* optimizer) : optimizer_(optimizer) {
    optimizer_->swap_average();
  }
  ~AverageScope() { optimizer_->swap_average(); }
  AverageScope(const AverageScope&) = delete;
  AverageScope& operator=(const AverageScope&) = delete;

 private:
  Optimizer* optimizer_;
};

}  // namespace lte::train
