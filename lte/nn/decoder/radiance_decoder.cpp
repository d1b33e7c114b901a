#include "lte/nn/decoder/radiance_decoder.h"

#include <cmath>

#include "lte/nn/points/surfels.h"
#include "lte/ops/gelu.h"
#include "lte/ops/lobe_radiance.h"
#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

/// What the answer starts with: mostly what rays see, and a share of the light around the point, as
/// points are too few to see everything.
constexpr double kFirstSeen = 0.8, kFirstLight = 0.2;

}  // namespace

RadianceDecoderImpl::RadianceDecoderImpl(int64_t latent, const ModelConfig& config)
    : lobes_per_point_(config.radiance_lobes),
      query_(register_module("query", QueryDecoder(latent, config, config.channels))) {
  const int64_t D = config.channels, K = config.radiance_lobes;
  // Axis and offset of each lobe, and the offset of each mixture of them.
  lobes_ = register_module("lobes", Linear(D, 5 * K));
  mix_ = register_module("mix", Linear(K + kSeenFeatures, K));
  color_ = register_module("color", Linear(K, 6));
  initialize(lobes_, 2);
  initialize(mix_, std::sqrt(2.0));
  initialize(color_, first_gain(config));
  const at::NoGradGuard no_grad;
  color_->bias.narrow(0, 0, 3).fill_(softplus_inverse(kFirstLight));
  color_->bias.narrow(0, 3, 3).fill_(softplus_inverse(kFirstSeen));
}

at::Tensor RadianceDecoderImpl::radiance(const at::Tensor& features, const at::Tensor& directions,
                                         const at::Tensor& light, const at::Tensor& seen) {
  const at::Tensor own = lobes_->forward(features);
  // Without gradients one operator does it all.
  if (!at::GradMode::is_enabled() && own.scalar_type() == at::kFloat)
    return ops::lobe_radiance_inference(
        own, directions.to(at::kFloat), light, seen,
        {{mix_->inference_weight(), mix_->bias}, {color_->inference_weight(), color_->bias}});
  const int64_t K = lobes_per_point_, Q = features.size(0);
  const at::Tensor axis = own.narrow(1, 0, 3 * K).view({Q, K, 3}),
                   offset = own.narrow(1, 3 * K, K).unsqueeze(1),
                   mixed = own.narrow(1, 4 * K, K).unsqueeze(1);
  const at::Tensor lobes =
      ops::gelu(at::baddbmm(offset, directions.to(own.scalar_type()), axis.transpose(1, 2)));
  const at::Tensor input =
      at::cat({lobes, seen.narrow(2, kSeenLog, kSeenFeatures).to(lobes.scalar_type())}, 2);
  const at::Tensor factor = at::softplus(color_->forward(ops::gelu(mix_->forward(input) + mixed)));
  return at::addcmul(factor.narrow(2, 0, 3) * light.unsqueeze(1), factor.narrow(2, 3, 3),
                     seen.narrow(2, kSeenRadiance, 3));
}

}  // namespace lte::nn
