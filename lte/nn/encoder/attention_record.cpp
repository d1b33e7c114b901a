#include "lte/nn/encoder/attention_record.h"

#include <cmath>
#include <limits>
#include <utility>

#include "lte/tensor/functions.h"

namespace lte::nn {

at::Tensor BlockAttention::weights(int64_t point) const {
  TORCH_CHECK_INDEX(point >= 0 && point < points(), "attention of point ", point, " of ", points());
  const at::NoGradGuard no_grad;
  const int64_t C = qkv.size(1) / 3, width = C / heads;
  at::Tensor others = qkv, rows;
  if (patch.gather.defined()) {
    const int64_t slot = patch.inverse[point].item<int64_t>();
    rows = patch.gather.narrow(0, slot / patch_size * patch_size, patch_size);
    others = qkv.index_select(0, rows);
  }
  const at::Tensor query = qkv[point].narrow(0, 0, C).view({heads, width});
  const at::Tensor key = others.narrow(1, C, C).view({-1, heads, width});
  const at::Tensor logits = (key * query).sum(2).div(std::sqrt(static_cast<double>(width)));
  const at::Tensor weight = at::softmax(logits, 0).t();
  if (!rows.defined()) return weight.contiguous();
  return at::zeros({heads, points()}, weight.options()).index_add_(1, rows, weight);
}

double BlockAttention::entropy() const {
  const at::NoGradGuard no_grad;
  const bool one_patch = !patch.gather.defined();
  const int64_t length = one_patch ? points() : patch_size;
  const int64_t width = qkv.size(1) / 3 / heads;
  if (length < 2) return std::numeric_limits<double>::quiet_NaN();
  const at::Tensor slots = one_patch ? qkv : qkv.index_select(0, patch.gather);
  const at::Tensor parts = slots.view({-1, length, 3, heads, width});
  double sum = 0;
  for (int64_t i = 0; i < parts.size(0); ++i) {  // one patch at a time: length² a head
    const at::Tensor q = parts[i].select(1, 0).transpose(0, 1),
                     k = parts[i].select(1, 1).transpose(0, 1);
    const at::Tensor logits =
        at::bmm(q, k.transpose(1, 2)).div(std::sqrt(static_cast<double>(width)));
    const at::Tensor rows = at::log_softmax(logits, 2);
    sum -= rows.exp().mul(rows).sum(2).mean().item<double>();
  }
  return sum / static_cast<double>(parts.size(0)) / std::log(static_cast<double>(length));
}

at::Tensor EncoderAttention::weights(size_t block, int64_t latent) const {
  const BlockAttention& of = blocks.at(block);
  return of.weights(point_of_latent.at(of.level)[latent].item<int64_t>());
}

void AttentionRecorder::plan(const EncoderPlan& plan) {
  record_->scene_point = plan.first_picks.index_select(0, plan.second_picks);
  record_->point_of_latent = {at::arange(plan.stages.front().points(), plan.first_picks.options())};
  for (size_t level = 1; level < plan.stages.size(); ++level) {
    record_->point_of_latent.push_back(
        plan.stages[level].cluster.index_select(0, record_->point_of_latent.back()));
  }
}

void AttentionRecorder::block(BlockAttention attention) {
  record_->blocks.push_back(std::move(attention));
}

void AttentionRecorder::stage(const std::string& name, size_t level,
                              const at::Tensor& /*features*/) {
  const size_t first = named_;
  for (; named_ < record_->blocks.size(); ++named_) {
    record_->blocks[named_].name = name + '.' + std::to_string(named_ - first);
    record_->blocks[named_].level = level;
  }
}

at::Tensor DecoderReading::shares() const {
  const at::Tensor magnitude = weights.abs().mean(3);
  const at::Tensor sum = magnitude.sum(2, /*keepdim=*/true);
  // A layer that weighs nothing at all has no preference.
  const double even = 1 / static_cast<double>(magnitude.size(2));
  return at::where(sum > 0, magnitude / at::where(sum > 0, sum, 1), even);
}

}  // namespace lte::nn
