#include "train/optim/weight_movement.h"

#include <algorithm>
#include <cmath>

#include <torch/types.h>

#include "train/optim/optimizer.h"

namespace lte::train {

WeightMovement::WeightMovement(const nn::LightTransportModel& start) {
  for (const auto& item : start->named_parameters()) {
    if (item.value().dim() < 2) continue;
    start_.push_back(item.value().detach().to(at::kCPU, /*non_blocking=*/false, /*copy=*/true));
  }
}

std::vector<std::pair<std::string, double>> WeightMovement::of(
    const nn::LightTransportModel& model) const {
  const torch::NoGradGuard no_grad;
  struct Squares {
    std::string module;
    double moved = 0, start = 0;
  };
  std::vector<Squares> modules;
  size_t next = 0;
  for (const auto& item : model->named_parameters()) {
    if (item.value().dim() < 2) continue;
    const std::string module = gradient_module(item.key());
    auto found = std::find_if(modules.begin(), modules.end(),
                              [&](const Squares& each) { return each.module == module; });
    if (found == modules.end()) found = modules.insert(found, {module});
    const at::Tensor& before = start_[next++];
    found->moved += item.value().cpu().sub(before).square().sum().item<double>();
    found->start += before.square().sum().item<double>();
  }
  std::vector<std::pair<std::string, double>> moved;
  for (const Squares& each : modules)
    moved.emplace_back(each.module, each.start > 0 ? std::sqrt(each.moved / each.start) : 0);
  return moved;
}

}  // namespace lte::train
