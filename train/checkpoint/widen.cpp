#include "train/checkpoint/widen.h"

#include <vector>

#include <ATen/TensorOperators.h>
#include <ATen/ops/randn_like.h>

namespace lte::train {
namespace {

/// Spread of the shares that readers of copies take, over the weights' own.
constexpr double kSpread = 0.25;

/// [..] with the axis from `blocks` times n to `blocks` times `factor` times n.
at::Tensor with_copies(const at::Tensor& values, int64_t axis, int64_t blocks, int64_t factor) {
  std::vector<int64_t> apart = values.sizes().vec(), copied;
  const auto at = apart.begin() + axis;
  const int64_t channels = *at / blocks;
  *at = channels;
  apart.insert(apart.begin() + axis, {blocks, 1});
  copied = apart;
  copied[static_cast<size_t>(axis) + 1] = factor;
  return values.reshape(apart).expand(copied).flatten(axis, axis + 2);
}

/// Adds numbers of this spread to the shares, whose sum over the copies is 0.
void part_shares(at::Tensor* weights, int64_t axis, int64_t blocks, int64_t factor, double spread) {
  std::vector<int64_t> apart = weights->sizes().vec();
  const auto at = apart.begin() + axis;
  const int64_t channels = *at / (blocks * factor);
  *at = channels;
  apart.insert(apart.begin() + axis, {blocks, factor});
  at::Tensor by_copy = weights->view(apart);
  const at::Tensor noise = at::randn_like(by_copy).mul_(spread);
  by_copy.add_(noise - noise.mean(axis + 1, /*keepdim=*/true));
}

/// Channels that stand side by side along an axis and are copied each for itself.
int64_t blocks_of(const std::string& name, bool inputs) {
  if (!inputs) return name.find(".qkv.") != std::string::npos ? 3 : 1;
  const bool of_pairs = name.starts_with("nne.") && name.ends_with(".hidden.weight") &&
                        !name.starts_with("nne.point.");
  return of_pairs ? 2 : 1;  // a neighbour's and the centre's
}

}  // namespace

int64_t widening(const nn::ModelConfig& model, const nn::ModelConfig& file) {
  const bool whole = model.channels % file.channels == 0 && model.head_width == file.head_width &&
                     file.channels % file.head_width == 0;
  return whole ? model.channels / file.channels : 1;
}

at::Tensor widened(const std::string& name, const at::Tensor& values, at::IntArrayRef shape,
                   int64_t factor) {
  const int64_t axes = values.dim();
  const int64_t outputs = axes == 3 ? 2 : 0, inputs = axes == 1 ? -1 : 1;
  at::Tensor out = values;
  if (shape[static_cast<size_t>(outputs)] != values.size(outputs))
    out = with_copies(out, outputs, blocks_of(name, false), factor);
  if (inputs < 0 || shape[static_cast<size_t>(inputs)] == values.size(inputs)) return out.clone();
  const int64_t blocks = blocks_of(name, true);
  out = with_copies(out, inputs, blocks, factor).div(static_cast<double>(factor));
  part_shares(&out, inputs, blocks, factor, kSpread * out.std().item<double>());
  return out;
}

}  // namespace lte::train
