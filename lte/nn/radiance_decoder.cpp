#include "lte/nn/radiance_decoder.h"

#include <cmath>

#include "lte/ops/gelu.h"

namespace lte::nn {

RadianceDecoderImpl::RadianceDecoderImpl(int64_t latent, const ModelConfig& config)
    : lobes_per_point_(config.radiance_lobes),
      query_(register_module("query", QueryDecoder(latent, config, config.channels))) {
  const int64_t D = config.channels, K = config.radiance_lobes;
  // Axis and offset of each lobe, and the offset of each mixture of them.
  lobes_ = register_module("lobes", Linear(D, 5 * K));
  mix_ = register_module("mix", Linear(K, K));
  color_ = register_module("color", Linear(K, 3));
  initialize(lobes_, 2);
  initialize(mix_, std::sqrt(2.0));
  initialize(color_, first_gain(config));
  const at::NoGradGuard no_grad;
  color_->bias.fill_(softplus_inverse(config.output_mean));
}

at::Tensor RadianceDecoderImpl::radiance(const at::Tensor& features, const at::Tensor& directions) {
  const int64_t K = lobes_per_point_, Q = features.size(0);
  const at::Tensor own = lobes_->forward(features);
  const at::Tensor axis = own.narrow(1, 0, 3 * K).view({Q, K, 3}),
                   offset = own.narrow(1, 3 * K, K).unsqueeze(1),
                   mixed = own.narrow(1, 4 * K, K).unsqueeze(1);
  const at::Tensor lobes =
      ops::gelu(at::baddbmm(offset, directions.to(own.scalar_type()), axis.transpose(1, 2)));
  return at::softplus(color_->forward(ops::gelu(mix_->forward(lobes) + mixed)));
}

}  // namespace lte::nn
