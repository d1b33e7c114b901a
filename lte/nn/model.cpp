#include "lte/nn/model.h"

#include <algorithm>
#include <cmath>

#include "lte/nn/constants.h"
#include "lte/nn/cost.h"
#include "lte/nn/nearest_neighbour_embedding.h"
#include "lte/nn/point_transformer.h"
#include "lte/nn/query_decoder.h"
#include "lte/ops/query_decoder.h"

namespace lte::nn {
namespace {

/// Queries decoded at a time. By the fused operator their neighbours are all that is kept, 50 MB;
/// else the intermediates are some 60 MB at D = 128 and stay in the outer caches' reach.
constexpr int64_t kTableBlock = int64_t{1} << 17, kQueryBlock = 4096;

/// log(1 + light/a) by channel: emission over its mean spans four decades, from dim panels to bare
/// bulbs, and direct irradiance as many.
at::Tensor compressed(const at::Tensor& light, const at::Tensor& emission_scale) {
  const at::Tensor a = emission_scale.to(light.device());
  return at::log1p(light.to(at::kDouble).div(at::where(a > 0, a, 1))).to(light.scalar_type());
}

at::Tensor surface_attributes(const at::Tensor& position, const at::Tensor& normal,
                              const at::Tensor& albedo) {
  const at::Tensor p = position.clamp(-kPositionLimit, kPositionLimit).mul(kPositionGain);
  return at::cat({p, normal, albedo}, 1);
}

}  // namespace

struct LightTransportModelImpl::Parts {
  NearestNeighbourEmbedding nne{nullptr};
  PointTransformer encoder{nullptr};
  QueryDecoder decoder{nullptr};

  /// [Q, 3] over the emission scale. Give either the table or keys and values.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries, const at::Tensor& keys,
                    const at::Tensor& values) {
    const at::Tensor position = (queries.position - embedding.origin).div(embedding.scale);
    const at::Tensor attributes = surface_attributes(position, queries.normal, queries.albedo);
    const Surface surface{position, queries.normal};
    if (!embedding.cache.defined()) return answers(embedding, attributes, surface, keys, values);
    const LightReading light = embedding.cache.read(position, queries.normal);
    return light.irradiance *
           answers(embedding, at::cat({attributes, light.features}, 1), surface, keys, values);
  }

  /// What the network says: irradiance, or the factor on that of the cache.
  at::Tensor answers(const Embedding& embedding, const at::Tensor& attributes, const Surface& query,
                     const at::Tensor& keys, const at::Tensor& values) {
    const Surface latents{embedding.position, embedding.normal};
    if (!keys.defined()) {
      return decoder->infer(attributes, query, latents, embedding.spacing, embedding.table);
    }
    const auto near = decoder->neighbourhood(query, latents, embedding.spacing);
    return decoder->forward(attributes, near, keys, values);
  }

  /// decode() from the table, the queries taken in an order in which neighbours share latents.
  at::Tensor decode_ordered(const Embedding& embedding, const QuerySet& queries) {
    const at::Tensor order = ops::spatial_order(queries.position.contiguous());
    const QuerySet ordered = {queries.position.index_select(0, order),
                              queries.normal.index_select(0, order),
                              queries.albedo.index_select(0, order)};
    const at::Tensor answer = decode(embedding, ordered, {}, {});
    return at::empty_like(answer).index_copy_(0, order, answer);
  }
};

LightTransportModelImpl::LightTransportModelImpl(const ModelConfig& config)
    : config_(config), parts_(std::make_shared<Parts>()) {
  parts_->nne =
      register_module("nne", NearestNeighbourEmbedding(config.point_inputs(), config.channels));
  parts_->encoder = register_module("encoder", PointTransformer(config));
  parts_->decoder = register_module("decoder", QueryDecoder(latent_width(config), config));
}

Embedding LightTransportModelImpl::encode(const PointSet& points, uint64_t order_seed,
                                          const Frame& frame) {
  return encode(points, order_seed, frame, nullptr);
}

std::vector<StageHealth> LightTransportModelImpl::stage_health(const PointSet& points) {
  const at::NoGradGuard no_grad;
  StageRecorder recorder;
  encode(points, 0, {}, &recorder);
  return recorder.stages();
}

Embedding LightTransportModelImpl::encode(const PointSet& points, uint64_t order_seed,
                                          const Frame& frame, StageRecorder* recorder) {
  check_points(points, config_);
  Embedding embedding;
  embedding.scale = frame.scale > 0 ? frame.scale : config_.scale;
  embedding.origin = frame.origin.defined() ? frame.origin.to(points.position.options())
                                            : std::get<0>(points.position.min(0));
  const at::Tensor position = (points.position - embedding.origin).div(embedding.scale);
  const double extent = position.max().item<double>();
  TORCH_CHECK(extent <= kLargestPosition, "scene points: the scene is ", extent * embedding.scale,
              " m wide, more than the model's scale of ", embedding.scale,
              " m; a larger Frame::scale shrinks it to fit");
  TORCH_CHECK(!frame.origin.defined() || position.min().item<double>() >= 0,
              "scene points: a position is less than the given least corner of the scene, ",
              embedding.origin[0].item<double>(), ", ", embedding.origin[1].item<double>(), ", ",
              embedding.origin[2].item<double>());
  embedding.emission_scale = emission_scale(points);

  const EncoderPlan plan =
      make_encoder_plan(position.to(at::kFloat).contiguous(), config_, is_training(), order_seed);
  std::vector<at::Tensor> attributes = {surface_attributes(position, points.normal, points.albedo),
                                        compressed(points.emission, embedding.emission_scale)};
  if (config_.reads_direct())
    attributes.push_back(compressed(points.direct, embedding.emission_scale));
  if (config_.reads_indirect())
    attributes.push_back(compressed(points.indirect, embedding.emission_scale));
  embedding.position = plan.position;
  embedding.spacing = plan.spacing;
  if (config_.reads_normals()) {
    const int64_t m = plan.position.size(0);
    embedding.normal = points.normal.index_select(0, plan.first_picks.narrow(0, 0, m));
  }
  embedding.features =
      parts_->encoder->forward(parts_->nne->forward(at::cat(attributes, 1), plan), plan, recorder);
  if (config_.reads_indirect()) {
    const at::Tensor a = embedding.emission_scale.to(points.indirect.options());
    const at::Tensor light = at::cat({points.indirect, points.direct}, 1);
    embedding.cache = make_light_cache(position, points.normal, points.emission,
                                       light.div(at::where(a > 0, a, 1).repeat({2})));
  }
  if (!at::GradMode::is_enabled() && embedding.features.scalar_type() == at::kFloat) {
    embedding.table = parts_->decoder->table(embedding.features);
  }
  return embedding;
}

void set_precision(torch::nn::Module& network, Precision precision) {
  for (const auto& module : network.modules(/*include_self=*/false)) {
    if (auto* linear = module->as<LinearImpl>()) linear->set_precision(precision);
    if (auto* convolution = module->as<SubmanifoldConvImpl>())
      convolution->set_precision(precision);
  }
}

void set_autocast(torch::nn::Module& network, Precision precision) {
  for (const auto& module : network.modules(/*include_self=*/false)) {
    if (auto* linear = module->as<LinearImpl>()) linear->set_autocast(precision);
    if (auto* convolution = module->as<SubmanifoldConvImpl>()) convolution->set_autocast(precision);
  }
}

void LightTransportModelImpl::set_precision(Precision precision) {
  nn::set_precision(*this, precision);
}

at::Tensor LightTransportModelImpl::decode_normalized(const Embedding& embedding,
                                                      const QuerySet& queries) {
  check_queries(queries);
  if (!at::GradMode::is_enabled() && embedding.table.defined()) {
    return parts_->decode(embedding, queries, {}, {});
  }
  const auto [keys, values] = parts_->decoder->keys_and_values(embedding.features);
  return parts_->decode(embedding, queries, keys, values);
}

at::Tensor LightTransportModelImpl::decode(const Embedding& embedding, const QuerySet& queries,
                                           const DecodeOptions& options) {
  TORCH_CHECK(options.block >= 0, "decode: blocks of ", options.block, " queries");
  const at::NoGradGuard no_grad;
  if (options.check_values) check_queries(queries);
  const int64_t Q = queries.position.size(0);
  // Light is linear: without emission there is no irradiance, whatever the network would say.
  if (embedding.emission_scale.max().item<double>() == 0) return at::zeros_like(queries.position);
  at::Tensor out = at::empty({Q, 3}, embedding.features.options());
  at::Tensor keys, values;
  if (!embedding.table.defined()) {
    std::tie(keys, values) = parts_->decoder->keys_and_values(embedding.features);
  }
  const bool fused = !keys.defined() && !is_training();
  const bool ordered = fused && queries.position.device().is_cpu();
  const int64_t fast = fused ? kTableBlock : kQueryBlock;
  const int64_t size = options.block > 0 ? std::min(options.block, fast) : fast;
  for (int64_t begin = 0; begin < Q; begin += size) {
    const int64_t count = std::min(size, Q - begin);
    const QuerySet block = {queries.position.narrow(0, begin, count),
                            queries.normal.narrow(0, begin, count),
                            queries.albedo.narrow(0, begin, count)};
    out.narrow(0, begin, count)
        .copy_(ordered ? parts_->decode_ordered(embedding, block)
                       : parts_->decode(embedding, block, keys, values));
  }
  for (int64_t c = 0; c < 3; ++c) {  // by number: a tensor's way to a GPU would be waited for
    out.select(1, c).mul_(embedding.emission_scale[c].item<double>());
  }
  return out;
}

}  // namespace lte::nn
