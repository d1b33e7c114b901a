#include "lte/nn/encoder/point_transformer.h"

#include <string>
#include <utility>

#include "lte/ops/gelu.h"

namespace lte::nn {

StageImpl::StageImpl(int64_t depth, int64_t channels, const ModelConfig& config) {
  for (int64_t i = 0; i < depth; ++i) {
    blocks_.push_back(register_module(std::to_string(i), TransformerBlock(channels, config)));
  }
}

at::Tensor StageImpl::forward(at::Tensor x, const StagePlan& plan, EncoderRecorder* recorder) {
  for (size_t i = 0; i < blocks_.size(); ++i) {
    if (recorder != nullptr) recorder->block(blocks_[i]->record_attention(x, plan, i));
    x = blocks_[i]->forward(x, plan, i);
  }
  return x;
}

PointTransformerImpl::PointTransformerImpl(const ModelConfig& config) {
  const int64_t D = config.channels;
  const auto down_width = [&](size_t s) { return config.encoder_widths[s] * D; };
  const auto up_width = [&](size_t s) { return config.decoder_widths[s] * D; };
  const size_t stages = config.encoder_depths.size();

  const bool centers = config.centers_norms();
  stem_ = register_module("stem", SubmanifoldConv(config.stem_kernel(), D, down_width(0), false));
  stem_norm_ = register_module("stem_norm", PointNorm(down_width(0), centers));
  for (size_t s = 0; s < stages; ++s) {
    const std::string number = std::to_string(s);
    if (s > 0) {
      pool_.push_back(
          register_module("pool" + number, Pooling(down_width(s - 1), down_width(s), centers)));
    }
    down_.push_back(
        register_module("down" + number, Stage(config.encoder_depths[s], down_width(s), config)));
  }
  for (size_t s = 0; s + 1 < stages; ++s) {
    const std::string number = std::to_string(s);
    const int64_t below = s + 2 < stages ? up_width(s + 1) : down_width(s + 1);
    unpool_.push_back(
        register_module("unpool" + number, Unpooling(below, down_width(s), up_width(s), centers)));
    up_.push_back(
        register_module("up" + number, Stage(config.decoder_depths[s], up_width(s), config)));
  }
  norm_ = register_module("norm", LayerNorm(stages > 1 ? up_width(0) : down_width(0)));
}

at::Tensor PointTransformerImpl::forward(const at::Tensor& x, const EncoderPlan& plan,
                                         EncoderRecorder* recorder) {
  const auto record = [&](const std::string& stage, size_t level, const at::Tensor& features) {
    if (recorder != nullptr) recorder->stage(stage, level, features);
  };
  if (recorder != nullptr) recorder->plan(plan);
  const at::Tensor stem = stem_->forward(x, plan.stem_pairs, plan.stem_tap_begin);
  std::vector<at::Tensor> skip = {ops::gelu(stem_norm_->forward(stem, plan.stages[0]))};
  record("stem", 0, skip[0]);
  for (size_t s = 0; s < down_.size(); ++s) {
    const StagePlan& stage = plan.stages[s];
    if (s > 0) {
      skip.push_back(pool_[s - 1]->forward(skip.back(), stage));
    }
    skip[s] = down_[s]->forward(skip[s], stage, recorder);
    record("down" + std::to_string(s), s, skip[s]);
  }
  at::Tensor y = skip.back();
  for (size_t s = up_.size(); s-- > 0;) {
    y = unpool_[s]->forward(y, skip[s], plan.stages[s + 1], plan.stages[s]);
    y = up_[s]->forward(y, plan.stages[s], recorder);
    record("up" + std::to_string(s), s, y);
  }
  return norm_->forward(y);
}

}  // namespace lte::nn
