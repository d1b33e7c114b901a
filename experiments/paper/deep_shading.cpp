#include "experiments/paper/deep_shading.h"

#include <cmath>
#include <string>

#include <ATen/ATen.h>
#include <torch/nn/init.h>

#include "experiments/paper/view_camera.h"
#include "infer/eval/baselines/denoised_paths.h"
#include "infer/eval/measure/eval_points.h"
#include "infer/eval/measure/scores.h"

namespace lte::experiments {
namespace {

constexpr double kLeak = 0.01;
constexpr double kDisplayPower = 1 / 2.2;
constexpr double kMetresPerUnit = 4;  // of positions: those of a room are then about 1

torch::nn::Conv2d convolution(int64_t inputs, int64_t outputs, int64_t groups) {
  torch::nn::Conv2d layer(torch::nn::Conv2dOptions(inputs, outputs, 3).padding(1).groups(groups));
  torch::nn::init::kaiming_normal_(layer->weight, kLeak);
  torch::nn::init::zeros_(layer->bias);
  return layer;
}

/// [H, W, 3] of values by pixel.
at::Tensor picture(const std::vector<Vec3>& values, const data::View& view) {
  at::Tensor out = at::empty({view.height, view.width, 3}, at::kFloat);
  std::copy(values.begin(), values.end(), reinterpret_cast<Vec3*>(out.data_ptr<float>()));
  return out;
}

at::Tensor displayed(const at::Tensor& light, double white) {
  return (light / white).clamp_min(0).pow(kDisplayPower);
}

at::Tensor answer(DeepShadingImpl& network, const ShadingView& view) {
  return network.forward(view.input)
      .narrow(2, 0, view.mask.size(0))
      .narrow(3, 0, view.mask.size(1));
}

}  // namespace

DeepShadingImpl::DeepShadingImpl() {
  int64_t inputs = kInputs;
  for (int64_t level = 0; level < kLevels; ++level) {
    const int64_t outputs = kChannels << level;
    down_.push_back(register_module("down" + std::to_string(level),
                                    convolution(inputs, outputs, int64_t{1} << level)));
    inputs = outputs;
  }
  for (int64_t level = kLevels - 2; level >= 0; --level) {
    const int64_t own = kChannels << level, outputs = level > 0 ? own : 1;
    up_.push_back(register_module("up" + std::to_string(level),
                                  convolution(2 * own + own, outputs, int64_t{1} << level)));
  }
}

at::Tensor DeepShadingImpl::forward(at::Tensor x) {
  std::vector<at::Tensor> levels;
  for (size_t i = 0; i < down_.size(); ++i) {
    if (i > 0) x = at::avg_pool2d(x, 2);
    x = at::leaky_relu(down_[i]->forward(x), kLeak);
    levels.push_back(x);
  }
  for (size_t i = 0; i < up_.size(); ++i) {
    const at::Tensor& own = levels[levels.size() - 2 - i];
    x = at::upsample_bilinear2d(x, own.sizes().slice(2), /*align_corners=*/false);
    x = at::leaky_relu(up_[i]->forward(at::cat({x, own}, 1)), kLeak);
  }
  return x;
}

at::Tensor structural_dissimilarity(const at::Tensor& a, const at::Tensor& b) {
  constexpr double kC1 = 1e-4, kC2 = 1e-3;  // of the authors
  const auto mean = [](const at::Tensor& x) { return at::avg_pool2d(x, 8, /*stride=*/1); };
  const at::Tensor ma = mean(a), mb = mean(b);
  const at::Tensor va = mean(a * a) - ma * ma, vb = mean(b * b) - mb * mb,
                   covariance = mean(a * b) - ma * mb;
  return 1 - ((2 * ma * mb + kC1) * (2 * covariance + kC2) /
              ((ma * ma + mb * mb + kC1) * (va + vb + kC2)))
                 .mean();
}

ShadingView shading_view(const data::View& view, int64_t light_groups, double radiance,
                         const image::Denoiser& denoiser) {
  ShadingView out;
  const infer::ViewPixels pixels(view, light_groups, radiance);
  const auto clean = [&](const std::vector<Rgb>& light) {
    return infer::denoised_paths(denoiser, view, light);
  };
  const std::vector<Rgb> direct = clean(pixels.points.direct);
  out.mask =
      at::from_blob(const_cast<uint8_t*>(view.mask.data()), {view.height, view.width}, at::kByte)
          .to(at::kBool);
  out.white = 1 / infer::white_exposure(direct);
  at::Tensor normal = picture(view.normal, view), position = picture(view.position, view);
  if (const auto camera = camera_of(view)) {
    const at::Tensor turn = camera->rotation.to(at::kFloat).t();
    normal = normal.matmul(turn);
    position = (position - camera->center.to(at::kFloat)).matmul(turn);
  } else {  // one plane fills the picture: seen as the world has it
    position = position - position.mean(at::IntArrayRef{0, 1});
  }
  const at::Tensor geometry = at::cat({normal, position / kMetresPerUnit}, 2)
                                  .masked_fill(~out.mask.unsqueeze(2), 0)
                                  .permute({2, 0, 1});
  const auto light = [&](const std::vector<Rgb>& values) {
    const image::Image seen = infer::fill_mask(values, view.mask, view.width, view.height);
    return displayed(at::tensor(seen.pixels).view({view.height, view.width, 3}), out.white)
        .permute({2, 0, 1})
        .unsqueeze(1);
  };
  const at::Tensor input =
      at::cat({light(direct), geometry.unsqueeze(0).expand({3, -1, -1, -1})}, 1);
  const auto room = [](int64_t side) { return -side & (DeepShadingImpl::kSideUnit - 1); };
  out.input = at::replication_pad2d(input, {0, room(view.width), 0, room(view.height)});
  out.target = light(clean(pixels.points.reference)).contiguous();
  return out;
}

std::vector<Rgb> shade(DeepShadingImpl& network, const ShadingView& view) {
  const at::NoGradGuard no_grad;
  const at::Tensor light =
      answer(network, view).squeeze(1).clamp_min(0).pow(1 / kDisplayPower).mul(view.white);
  const at::Tensor pixels = light.permute({1, 2, 0}).index({view.mask}).contiguous();
  const auto* values = reinterpret_cast<const Rgb*>(pixels.const_data_ptr<float>());
  return {values, values + pixels.size(0)};
}

at::Tensor shading_loss(DeepShadingImpl& network, const ShadingView& view) {
  const at::Tensor seen = answer(network, view).masked_fill(~view.mask, 0);
  return structural_dissimilarity(seen, view.target);
}

}  // namespace lte::experiments
