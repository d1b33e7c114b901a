// What the stages of the encoder carry for a scene: whether a network uses its depth and its
// attention, or has stages that say the same of every point.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/nn/encoder/attention_record.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

struct StageHealth {
  std::string stage;   ///< as in the names of parameters: "stem", "down0", ..., "up0"
  int64_t points = 0;  ///< n
  double rms = 0;      ///< of the features that leave the stage
  /// Of that rms the share that differs between points: the root of the mean over channels of the
  /// variance over points, over the rms. 0: one vector for all points.
  double varying = 0;
  /// Entropy of the rows of attention over log n, a mean over blocks, heads and points. 1: every
  /// point takes the plain mean of all. NaN where the stage has no block or patches of one point.
  double entropy = 0;

  /// Whether the stage says nearly the same of all points. Of fewer than kFewPoints points that is
  /// no fault.
  bool collapsed() const { return points >= kFewPoints && varying < kMinVarying; }

  /// Stages as initialized have 0.6 to 0.8.
  static constexpr double kMinVarying = 0.25;
  static constexpr int64_t kFewPoints = 8;
};

/// Collects what the stages of one pass through the encoder carry.
class StageRecorder : public EncoderRecorder {
 public:
  void block(BlockAttention attention) override { block(attention.entropy()); }
  void stage(const std::string& name, size_t /*level*/, const at::Tensor& features) override {
    stage(name, features);
  }
  /// The same from the entropy alone, and of whatever resolution.
  void block(double entropy) { entropies_.push_back(entropy); }
  void stage(const std::string& name, const at::Tensor& features);

  const std::vector<StageHealth>& stages() const { return stages_; }

 private:
  std::vector<StageHealth> stages_;
  std::vector<double> entropies_;  ///< of the stage that is under way
};

}  // namespace lte::nn
