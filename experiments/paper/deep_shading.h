// Deep Shading (Nalbach et al. 2017) for indirect light: a convolutional network over what a
// picture shows of its surfaces, one color channel at a time.
#pragma once

#include <cstdint>
#include <vector>

#include <torch/nn/module.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/pimpl.h>

#include "infer/eval/measure/eval_points.h"
#include "lte/data/scene_sample.h"
#include "lte/image/denoise.h"

namespace lte::experiments {

/// Five levels of 16 to 256 channels and half the size each, in groups whose number doubles, and
/// back up beside what each level had: 133,489 parameters, as the authors' network for indirect
/// light. Parameters: `down<I>.*`, `up<I>.*`.
class DeepShadingImpl : public torch::nn::Module {
 public:
  static constexpr int64_t kLevels = 5, kChannels = 16, kInputs = 7;
  static constexpr int64_t kSideUnit = int64_t{1} << (kLevels - 1);

  DeepShadingImpl();

  /// @param x  [B, 7, H, W]: direct light of one channel, normal and position before the camera;
  ///           sides are multiples of kSideUnit
  /// @return   [B, 1, H, W], as the direct light is displayed
  at::Tensor forward(at::Tensor x);

 private:
  std::vector<torch::nn::Conv2d> down_, up_;
};
TORCH_MODULE(DeepShading);

/// One minus the structural similarity of values of which 1 is white, by windows of 8 x 8 pixels.
/// @param a, b  [B, 1, H, W], sides of at least 8
at::Tensor structural_dissimilarity(const at::Tensor& a, const at::Tensor& b);

/// A view as the network reads it. Irradiance is displayed by the power 1/2.2 over `white`, of
/// which both light that is given and light that is answered are.
struct ShadingView {
  at::Tensor input;   ///< [3, 7, H', W'], a channel of light each, padded to multiples
  at::Tensor target;  ///< [3, 1, H, W]
  at::Tensor mask;    ///< [H, W] bool: pixels that count
  double white = 1;   ///< 99th percentile of direct irradiance; 1 where there is none
};

/// @param radiance  emission scalar
/// @param denoiser  of both kinds of light: noise in what is to be learnt would teach contrast, as
///                  structural similarity has it
ShadingView shading_view(const data::View& view, int64_t light_groups, double radiance,
                         const image::Denoiser& denoiser);

/// What the network answers at the pixels whose mask is set, over the emission scalar.
std::vector<Rgb> shade(DeepShadingImpl& network, const ShadingView& view);

/// structural_dissimilarity() of the network's answer.
at::Tensor shading_loss(DeepShadingImpl& network, const ShadingView& view);

}  // namespace lte::experiments
