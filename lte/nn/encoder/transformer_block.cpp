#include "lte/nn/encoder/transformer_block.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lte/nn/constants.h"
#include "lte/ops/norm_layers.h"
#include "lte/ops/patch_attention.h"
#include "lte/ops/rotary.h"
#include "lte/ops/submanifold_conv.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/module.h"

namespace lte::nn {
namespace {

const PatchMap& patch_map(const SceneRows& rows, size_t order) {
  return rows.patches[order % rows.patches.size()];
}

/// Points below which it costs more to arrange the weights of a norm's layers than it gains.
constexpr int64_t kMinFused = 512;

/// Whether a norm of x and the layers that follow it are one operator.
bool fuses(const at::Tensor& x) {
  return ops::suits_norm_layers(x) && (at::GradMode::is_enabled() || x.size(0) >= kMinFused);
}

/// Keeps LibTorch from taking cuDNN's attention, which it prefers for bfloat16 on Hopper and which
/// needs a plan for every length that it has not seen before (pytorch#155958): scenes hardly ever
/// have the same one twice.
class WithoutCudnnAttention {
 public:
  WithoutCudnnAttention() : before_(at::globalContext().userEnabledCuDNNSDP()) {
    at::globalContext().setSDPUseCuDNN(false);
  }
  ~WithoutCudnnAttention() { at::globalContext().setSDPUseCuDNN(before_); }
  WithoutCudnnAttention(const WithoutCudnnAttention&) = delete;
  WithoutCudnnAttention& operator=(const WithoutCudnnAttention&) = delete;

 private:
  bool before_;
};

/// The rows of each scene. Split at once, for gradients to be put together by one copy.
std::vector<at::Tensor> rows_of_scenes(const at::Tensor& x, const StagePlan& stage) {
  if (stage.scenes.size() == 1) return {x};
  std::vector<int64_t> counts;
  for (const SceneRows& rows : stage.scenes) counts.push_back(rows.count);
  return x.split_with_sizes(counts);
}

/// The mean of the rows. In double, where the order of a sum is no matter.
at::Tensor mean_row(const at::Tensor& x) {
  return x.mean(0, /*keepdim=*/false, at::kDouble).to(x.scalar_type());
}

/// Means of [n, C] over the points of each scene, [scenes, C].
at::Tensor means_of_scenes(const at::Tensor& x, const StagePlan& stage) {
  std::vector<at::Tensor> means;
  for (const at::Tensor& of_scene : rows_of_scenes(x, stage)) means.push_back(mean_row(of_scene));
  return at::stack(means);
}

}  // namespace

PatchAttentionImpl::PatchAttentionImpl(int64_t channels, int64_t heads, double dropout)
    : heads_(heads),
      dropout_(dropout),
      qkv_(register_module("qkv", Linear(channels, 3 * channels))),
      proj_(register_module("proj", Linear(channels, channels))) {}

at::Tensor PatchAttentionImpl::turned(const at::Tensor& qkv, const StagePlan& stage) {
  return stage.cosine.defined() ? ops::rotate_heads(qkv, stage.cosine, stage.sine, heads_) : qkv;
}

BlockAttention PatchAttentionImpl::record(const at::Tensor& x, const StagePlan& stage, size_t order,
                                          int64_t patch_size) {
  const at::NoGradGuard no_grad;
  BlockAttention out;
  out.heads = heads_;
  out.qkv = turned(qkv_->forward(x), stage);
  out.patch = patch_map(stage.scenes.front(), order);
  out.patch_size = patch_size;
  return out;
}

at::Tensor PatchAttentionImpl::forward(const at::Tensor& x, const StagePlan& stage, size_t order,
                                       int64_t patch_size) {
  return project(attend_in_scenes(qkv_->forward(x), stage, order, patch_size));
}

at::Tensor PatchAttentionImpl::project(const at::Tensor& attended) {
  return at::dropout(proj_->forward(attended), dropout_, is_training());
}

at::Tensor PatchAttentionImpl::forward(const at::Tensor& x, LayerNorm& norm, const StagePlan& stage,
                                       size_t order, int64_t patch_size) {
  return project(attended(x, norm, stage, order, patch_size));
}

at::Tensor PatchAttentionImpl::attended(const at::Tensor& x, LayerNorm& norm,
                                        const StagePlan& stage, size_t order, int64_t patch_size) {
  const at::Tensor qkv = fuses(x) ? ops::norm_linear(x, {norm->weight, norm->bias}, qkv_->weights())
                                  : qkv_->forward(norm->forward(x));
  return attend_in_scenes(qkv, stage, order, patch_size);
}

at::Tensor PatchAttentionImpl::attend_in_scenes(const at::Tensor& separate, const StagePlan& stage,
                                                size_t order, int64_t patch_size) {
  const std::vector<at::Tensor> qkv = rows_of_scenes(turned(separate, stage), stage);
  std::vector<at::Tensor> attended;
  for (size_t i = 0; i < qkv.size(); ++i)
    attended.push_back(attend(qkv[i], patch_map(stage.scenes[i], order), patch_size));
  return attended.size() == 1 ? attended.front() : at::cat(attended);
}

at::Tensor PatchAttentionImpl::attend(const at::Tensor& points, const PatchMap& map,
                                      int64_t patch_size) {
  const int64_t n = points.size(0), C = points.size(1) / 3;
  const bool one_patch = !map.gather.defined();
  if (points.device().is_cpu() && points.scalar_type() == at::kFloat &&
      C / heads_ <= ops::kWidestHead) {
    if (!at::GradMode::is_enabled() && !is_training()) {
      return ops::patch_attention_inference(points, map.gather, map.inverse, heads_, patch_size,
                                            qkv_->in_bf16());
    }
    return ops::patch_attention(points, map.gather, map.inverse, heads_, patch_size,
                                qkv_->in_autocast() || qkv_->in_bf16());
  }
  at::Tensor qkv = one_patch ? points : points.index_select(0, map.gather);
  const int64_t length = one_patch ? n : patch_size;
  const bool flash = (qkv_->in_autocast() || qkv_->in_bf16()) && qkv.is_cuda();
  if (flash) qkv = qkv.to(at::kBFloat16);
  // Three of [patches, heads, length, C / heads]. Unbound before they are transposed, so that the
  // gradient is put together by one copy.
  std::vector<at::Tensor> part = qkv.view({-1, length, 3, heads_, C / heads_}).unbind(2);
  for (at::Tensor& t : part) t = t.transpose(1, 2);
  std::optional<WithoutCudnnAttention> scope;
  if (flash) scope.emplace();
  at::Tensor out = at::scaled_dot_product_attention(part[0], part[1], part[2]);
  out = out.transpose(1, 2).reshape({-1, C});
  if (flash) out = out.to(at::kFloat);
  return one_patch ? out : out.index_select(0, map.inverse);
}

PointNormImpl::PointNormImpl(int64_t channels, bool centers)
    : weight_(register_parameter("weight", at::ones({channels}))),
      bias_(register_parameter("bias", at::zeros({channels}))) {
  if (centers) share_ = register_parameter("share", at::ones({channels}));
}

at::Tensor PointNormImpl::forward(const at::Tensor& x, const StagePlan& stage) {
  at::Tensor centered = x;
  if (share_.defined()) {
    const at::Tensor common = stage.scenes.size() == 1
                                  ? mean_row(x)
                                  : means_of_scenes(x, stage).index_select(0, stage.scene);
    centered = x - common.mul(share_);
  }
  return ops::layer_norm(centered, {weight_, bias_});
}

at::Tensor PointNormImpl::after(Linear& linear, const at::Tensor& x, const StagePlan& stage,
                                const at::Tensor& residual) {
  if (fuses(x)) {
    std::vector<int64_t> counts;
    for (const SceneRows& rows : stage.scenes) counts.push_back(rows.count);
    return ops::linear_norm(x, linear->weights(), {{weight_, bias_}, share_}, counts, residual);
  }
  const at::Tensor normed = forward(linear->forward(x), stage);
  return residual.defined() ? residual + normed : normed;
}

SubmanifoldConvImpl::SubmanifoldConvImpl(int64_t kernel, int64_t inputs, int64_t outputs,
                                         bool with_bias) {
  const int64_t taps = kernel * kernel * kernel;
  // The bound of a dense convolution: U(±1/sqrt(fan_in)).
  const double bound = 1 / std::sqrt(static_cast<double>(taps * inputs));
  weight_ = register_parameter("weight", at::empty({taps, inputs, outputs}));
  torch::nn::init::uniform_(weight_, -bound, bound);
  if (!with_bias) return;
  bias_ = register_parameter("bias", at::empty({outputs}));
  torch::nn::init::uniform_(bias_, -bound, bound);
}

at::Tensor SubmanifoldConvImpl::forward(const at::Tensor& x, const at::Tensor& pairs,
                                        const at::Tensor& tap_begin) {
  if (autocast_ && at::GradMode::is_enabled())
    return ops::submanifold_conv_autocast(x, weight_, bias_, pairs, tap_begin);
  const bool rounded = rounded_.defined() && !at::GradMode::is_enabled();
  return ops::submanifold_conv(x, rounded ? rounded_ : weight_, bias_, pairs, tap_begin);
}

void SubmanifoldConvImpl::set_precision(Precision precision) {
  const bool whole = weight_.size(2) % ops::kConvolutionBlock == 0;
  rounded_ =
      precision == Precision::Bf16 && whole ? weight_.detach().to(at::kBFloat16) : at::Tensor();
}

TransformerBlockImpl::TransformerBlockImpl(int64_t channels, const ModelConfig& config)
    : patch_size_(config.patch_size),
      conv_(register_module("conv", SubmanifoldConv(kBlockKernel, channels, channels, true))),
      conv_linear_(register_module("conv_linear", Linear(channels, channels))),
      conv_norm_(register_module("conv_norm", PointNorm(channels, config.centers_norms()))),
      norm1_(register_module("norm1", LayerNorm(channels))),
      norm2_(register_module("norm2", LayerNorm(channels))) {
  const int64_t heads = std::max<int64_t>(1, channels / config.head_width);
  attention_ = register_module("attention", PatchAttention(channels, heads, config.dropout));
  mlp_ = register_module("mlp", Mlp(channels, 4 * channels, channels, config.dropout, 0.5));
}

at::Tensor TransformerBlockImpl::convolve(const at::Tensor& input, const StagePlan& stage) {
  const at::Tensor x = conv_->forward(input, stage.pairs, stage.tap_begin);
  return conv_norm_->after(conv_linear_, x, stage, input);
}

BlockAttention TransformerBlockImpl::record_attention(const at::Tensor& input,
                                                      const StagePlan& stage, size_t order) {
  const at::NoGradGuard no_grad;
  return attention_->record(norm1_->forward(convolve(input, stage)), stage, order, patch_size_);
}

at::Tensor TransformerBlockImpl::forward(const at::Tensor& input, const StagePlan& stage,
                                         size_t order) {
  at::Tensor x = convolve(input, stage);
  if (fuses(x) && !mlp_->drops()) {
    return ops::project_feed_forward(x, attention_->attended(x, norm1_, stage, order, patch_size_),
                                     attention_->projection(), {norm2_->weight, norm2_->bias},
                                     mlp_->weights());
  }
  x = x + attention_->forward(x, norm1_, stage, order, patch_size_);
  return x + mlp_->forward(norm2_->forward(x));
}

}  // namespace lte::nn
