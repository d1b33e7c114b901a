#include "lte/nn/radiance_decoder.h"

#include <cmath>

#include <ATen/ATen.h>

#include "lte/nn/surfels.h"
#include "lte/ops/gelu.h"
#include "lte/ops/lobe_radiance.h"

namespace lte::nn {
namespace {

/// What the answer starts with where rays are cast: mostly what they see, and a share of the
/// light that is told, as points are too few to see everything.
constexpr double kFirstSeen = 0.8, kFirstLight = 0.2;
/// What the sharpness of spherical Gaussians starts with: a half-width of about 35 degrees.
constexpr double kFirstSharpness = 4;

/// Makes r and s of a layer start with what they should where softplus follows it.
void start_factors(Linear& last, const ModelConfig& config) {
  initialize(last, first_gain(config));
  const bool casts = config.casts_rays();
  const at::NoGradGuard no_grad;
  last->bias.narrow(0, 0, 3).fill_(softplus_inverse(casts ? kFirstLight : config.output_mean));
  if (casts) last->bias.narrow(0, 3, 3).fill_(softplus_inverse(kFirstSeen));
}

int64_t factors(const ModelConfig& config) { return config.casts_rays() ? 6 : 3; }

}  // namespace

int64_t direction_inputs(const ModelConfig& config) {
  return 3 + (config.casts_rays() ? kSeenFeatures : 0);
}

RadianceDecoderImpl::RadianceDecoderImpl(int64_t latent, const ModelConfig& config)
    : kind_(config.radiance_head),
      lobes_per_point_(config.radiance_lobes),
      query_(register_module(
          "query", config.enters_early()
                       ? QueryDecoder(latent, config, factors(config), direction_inputs(config))
                       : QueryDecoder(latent, config, config.channels))) {
  if (kind_ == RadianceHead::Directions) make_directions(config);
  if (kind_ == RadianceHead::Map) make_map(config);
  if (kind_ == RadianceHead::Gaussians) make_gaussians(config);
  if (kind_ == RadianceHead::Early) start_factors(query_->head()->output(), config);
}

void RadianceDecoderImpl::make_directions(const ModelConfig& config) {
  const int64_t D = config.channels, K = config.radiance_lobes;
  // Axis and offset of each lobe, and the offset of each mixture of them.
  lobes_ = register_module("lobes", Linear(D, 5 * K));
  mix_ = register_module("mix", Linear(K + (config.casts_rays() ? kSeenFeatures : 0), K));
  color_ = register_module("color", Linear(K, factors(config)));
  initialize(lobes_, 2);
  initialize(mix_, std::sqrt(2.0));
  start_factors(color_, config);
}

void RadianceDecoderImpl::make_map(const ModelConfig& config) {
  const int64_t cells = config.radiance_lobes * config.radiance_lobes;
  map_ = register_module("map", Linear(config.channels, 3 * cells));
  initialize(map_, first_gain(config));
  const at::NoGradGuard no_grad;
  map_->bias.fill_(softplus_inverse(config.output_mean));
}

void RadianceDecoderImpl::make_gaussians(const ModelConfig& config) {
  const int64_t K = config.radiance_lobes;
  gaussians_ = register_module("gaussians", Linear(config.channels, 7 * K));
  initialize(gaussians_, 1);
  const at::NoGradGuard no_grad;
  // Axes all around, and amplitudes so that K Gaussians add up to about output_mean everywhere.
  const at::Tensor bias = gaussians_->bias;
  const at::Tensor axes = at::randn({K, 3});
  bias.narrow(0, 0, 3 * K).copy_(axes.div(axes.norm(2, {1}, true)).mul(3).view({-1}));
  bias.narrow(0, 3 * K, K).fill_(softplus_inverse(kFirstSharpness));
  const double covered = static_cast<double>(K) / (2 * kFirstSharpness);
  bias.narrow(0, 4 * K, 3 * K).fill_(softplus_inverse(config.output_mean / std::max(covered, 1.0)));
}

at::Tensor RadianceDecoderImpl::radiance(const at::Tensor& features, const at::Tensor& directions,
                                         const at::Tensor& light, const at::Tensor& seen) {
  // Without gradients one operator does it all.
  if (kind_ == RadianceHead::Directions && !at::GradMode::is_enabled() &&
      features.scalar_type() == at::kFloat)
    return ops::lobe_radiance_inference(
        lobes_->forward(features), directions.to(at::kFloat), light, seen,
        {{mix_->inference_weight(), mix_->bias}, {color_->inference_weight(), color_->bias}});
  const at::Tensor factor = ask(features, directions, seen);
  const at::Tensor even = factor.narrow(2, 0, 3);
  const at::Tensor answer = light.defined() ? even * light.unsqueeze(1) : even;
  if (!seen.defined()) return answer;
  return at::addcmul(answer, factor.narrow(2, 3, 3), seen.narrow(2, kSeenRadiance, 3));
}

at::Tensor RadianceDecoderImpl::ask(const at::Tensor& features, const at::Tensor& directions,
                                    const at::Tensor& seen) {
  switch (kind_) {
    case RadianceHead::Directions:
      return ask_directions(features, directions, seen);
    case RadianceHead::Map:
      return ask_map(features, directions);
    case RadianceHead::Gaussians:
      return ask_gaussians(features, directions);
    case RadianceHead::Early:
      break;  // asked before its attention
  }
  return features.view({directions.size(0), directions.size(1), features.size(1)});
}

at::Tensor RadianceDecoderImpl::ask_directions(const at::Tensor& features,
                                               const at::Tensor& directions,
                                               const at::Tensor& seen) {
  const int64_t K = lobes_per_point_, Q = features.size(0);
  const at::Tensor own = lobes_->forward(features);
  const at::Tensor axis = own.narrow(1, 0, 3 * K).view({Q, K, 3}),
                   offset = own.narrow(1, 3 * K, K).unsqueeze(1),
                   mixed = own.narrow(1, 4 * K, K).unsqueeze(1);
  at::Tensor lobes =
      ops::gelu(at::baddbmm(offset, directions.to(own.scalar_type()), axis.transpose(1, 2)));
  if (seen.defined())
    lobes = at::cat({lobes, seen.narrow(2, kSeenLog, kSeenFeatures).to(lobes.scalar_type())}, 2);
  return at::softplus(color_->forward(ops::gelu(mix_->forward(lobes) + mixed)));
}

at::Tensor RadianceDecoderImpl::ask_map(const at::Tensor& features, const at::Tensor& directions) {
  const int64_t K = lobes_per_point_;
  const at::Tensor map = at::softplus(map_->forward(features)).view({-1, K * K, 3});
  const at::Tensor cells = octahedral_cells(directions, K).unsqueeze(2).expand({-1, -1, 3});
  return map.gather(1, cells);
}

at::Tensor RadianceDecoderImpl::ask_gaussians(const at::Tensor& features,
                                              const at::Tensor& directions) {
  const int64_t K = lobes_per_point_, Q = features.size(0);
  const at::Tensor own = gaussians_->forward(features);
  const at::Tensor axis = own.narrow(1, 0, 3 * K).view({Q, K, 3});
  const at::Tensor unit = axis.div(axis.norm(2, {2}, true).clamp_min(1e-6));
  const at::Tensor sharpness = at::softplus(own.narrow(1, 3 * K, K)).unsqueeze(1);
  const at::Tensor amplitude = at::softplus(own.narrow(1, 4 * K, 3 * K)).view({Q, K, 3});
  const at::Tensor cosine = at::bmm(directions.to(own.scalar_type()), unit.transpose(1, 2));
  return at::bmm((sharpness * (cosine - 1)).exp(), amplitude);
}

at::Tensor octahedral_cells(const at::Tensor& directions, int64_t edge) {
  const at::Tensor flat = directions.div(directions.abs().sum(2, true));
  const at::Tensor xy = flat.narrow(2, 0, 2), z = flat.narrow(2, 2, 1);
  // The lower half folds over the diagonals.
  const at::Tensor folded = (1 - xy.flip({2}).abs()) * at::where(xy >= 0, 1.0, -1.0).to(xy);
  const at::Tensor place =
      at::where(z >= 0, xy, folded).add(1).mul(0.5 * static_cast<double>(edge));
  const at::Tensor cell = place.floor().to(at::kLong).clamp(0, edge - 1);
  return cell.select(2, 1) * edge + cell.select(2, 0);
}

}  // namespace lte::nn
