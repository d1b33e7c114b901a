#include "lte/nn/encoder/stage_health.h"

#include <cmath>
#include <limits>

#include "lte/tensor/functions.h"

namespace lte::nn {

void StageRecorder::stage(const std::string& name, const at::Tensor& features) {
  const at::Tensor x = features.detach().to(at::kDouble);
  const double rms = std::sqrt(x.square().mean().item<double>());
  const double between = std::sqrt((x - x.mean(0)).square().mean().item<double>());
  double sum = 0;
  for (const double entropy : entropies_) sum += entropy;
  const double mean = entropies_.empty() ? std::numeric_limits<double>::quiet_NaN()
                                         : sum / static_cast<double>(entropies_.size());
  stages_.push_back({name, x.size(0), rms, rms > 0 ? between / rms : 0, mean});
  entropies_.clear();
}

}  // namespace lte::nn
