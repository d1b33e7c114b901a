#include "lte/nn/model.h"

#include <algorithm>
#include <cmath>

#include "lte/nn/attention_record.h"
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

  /// What the decoder reads of queries of one scene, and the light that its answer is a factor on,
  /// if it is one.
  struct Asked {
    at::Tensor attributes, light;
    SceneQueries queries;
  };
  static Asked ask(const Embedding& embedding, const QuerySet& queries) {
    Asked asked;
    const at::Tensor position = (queries.position - embedding.origin).div(embedding.scale);
    asked.attributes = surface_attributes(position, queries.normal, queries.albedo);
    asked.queries = {
        {position, queries.normal}, {embedding.position, embedding.normal}, embedding.spacing};
    if (embedding.cache.defined()) {
      const LightReading reading = embedding.cache.read(position, queries.normal);
      asked.attributes = at::cat({asked.attributes, reading.features}, 1);
      asked.light = reading.irradiance;
    }
    return asked;
  }

  /// [Q, 3] over the emission scale, from the embedding's table.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries) {
    const Asked asked = ask(embedding, queries);
    const at::Tensor answer =
        decoder->infer(asked.attributes, asked.queries.query, asked.queries.anchor,
                       embedding.spacing, embedding.table);
    return asked.light.defined() ? asked.light * answer : answer;
  }

  /// The same, differentiable, for each of some scenes, the decoder run once for the queries of all
  /// of them.
  std::vector<at::Tensor> decode(const std::vector<Embedding>& scenes,
                                 const std::vector<QuerySet>& queries,
                                 const LatentTables& latents) {
    std::vector<at::Tensor> attributes, light;
    std::vector<SceneQueries> asked_for;
    std::vector<int64_t> counts;
    for (size_t i = 0; i < queries.size(); ++i) {
      const Asked asked = ask(scenes[i], queries[i]);
      attributes.push_back(asked.attributes);
      asked_for.push_back(asked.queries);
      if (asked.light.defined()) light.push_back(asked.light);
      counts.push_back(queries[i].position.size(0));
    }
    at::Tensor answer = decoder->forward(at::cat(attributes), asked_for, latents);
    if (!light.empty()) answer = answer * at::cat(light);
    return answer.split_with_sizes(counts);
  }

  /// decode() from the table, the queries taken in an order in which neighbours share latents.
  at::Tensor decode_ordered(const Embedding& embedding, const QuerySet& queries) {
    const at::Tensor order = ops::spatial_order(queries.position.contiguous());
    const QuerySet ordered = {queries.position.index_select(0, order),
                              queries.normal.index_select(0, order),
                              queries.albedo.index_select(0, order)};
    const at::Tensor answer = decode(embedding, ordered);
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

/// What F reads of the light on scene points, and the cache of it.
void LightTransportModelImpl::add_light(const PointSet& points, const at::Tensor& position,
                                        std::vector<at::Tensor>* columns,
                                        Embedding* embedding) const {
  if (!config_.reads_direct()) return;
  const auto sides = [&](const at::Tensor& both, const at::Tensor& back) {
    if (!config_.parts_sides()) return std::vector{both};
    return std::vector{both - back, back};
  };
  const std::vector<at::Tensor> direct = sides(points.direct, points.direct_back);
  for (const at::Tensor& side : direct)
    columns->push_back(compressed(side, embedding->emission_scale));
  if (!config_.reads_indirect()) return;
  const std::vector<at::Tensor> indirect = sides(points.indirect, points.indirect_back);
  const at::Tensor a = embedding->emission_scale.to(points.indirect.options());
  const at::Tensor scale = at::where(a > 0, a, 1).repeat({2});
  std::vector<at::Tensor> light;
  for (size_t side = 0; side < indirect.size(); ++side) {
    columns->push_back(compressed(indirect[side], embedding->emission_scale));
    light.push_back(at::cat({indirect[side], direct[side]}, 1).div(scale));
  }
  const at::Tensor error = config_.light_variance ? points.indirect_error : at::Tensor();
  if (error.defined()) columns->push_back(error);
  embedding->cache =
      make_light_cache(position, points.normal, points.emission, at::cat(light, 1), error);
}

/// A scene's place in network space and the scale of its light; what F reads of its points goes to
/// `attributes`, where they lie to `position`.
Embedding LightTransportModelImpl::place(const PointSet& points, const Frame& frame,
                                         at::Tensor* position, at::Tensor* attributes) const {
  check_points(points, config_);
  Embedding embedding;
  embedding.scale = frame.scale > 0 ? frame.scale : config_.scale;
  embedding.origin = frame.origin.defined() ? frame.origin.to(points.position.options())
                                            : std::get<0>(points.position.min(0));
  *position = (points.position - embedding.origin).div(embedding.scale);
  const double extent = position->max().item<double>();
  TORCH_CHECK(extent <= kLargestPosition, "scene points: the scene is ", extent * embedding.scale,
              " m wide, more than the model's scale of ", embedding.scale,
              " m; a larger Frame::scale shrinks it to fit");
  TORCH_CHECK(!frame.origin.defined() || position->min().item<double>() >= 0,
              "scene points: a position is less than the given least corner of the scene, ",
              embedding.origin[0].item<double>(), ", ", embedding.origin[1].item<double>(), ", ",
              embedding.origin[2].item<double>());
  embedding.emission_scale = emission_scale(points);
  std::vector<at::Tensor> columns = {surface_attributes(*position, points.normal, points.albedo),
                                     compressed(points.emission, embedding.emission_scale)};
  add_light(points, *position, &columns, &embedding);
  *attributes = at::cat(columns, 1);
  return embedding;
}

SceneBatch LightTransportModelImpl::encode(const std::vector<PointSet>& scenes,
                                           const std::vector<uint64_t>& order_seeds,
                                           const Frame& frame, EncoderRecorder* recorder) {
  SceneBatch batch;
  std::vector<at::Tensor> positions, attributes, normals;
  for (const PointSet& points : scenes) {
    at::Tensor position, columns;
    batch.scenes.push_back(place(points, frame, &position, &columns));
    positions.push_back(position.to(at::kFloat).contiguous());
    attributes.push_back(columns);
    normals.push_back(points.normal);
  }
  const EncoderPlan plan = make_encoder_plan(positions, config_, is_training(), order_seeds);
  batch.features = parts_->encoder->forward(
      parts_->nne->forward(attributes.size() == 1 ? attributes[0] : at::cat(attributes), plan),
      plan, recorder);
  at::Tensor normal;
  if (config_.reads_normals())
    normal = at::cat(normals).index_select(0, plan.first_picks.index_select(0, plan.second_picks));
  for (size_t i = 0; i < batch.scenes.size(); ++i) {
    const SceneRows& rows = plan.stages.front().scenes[i];
    const auto own = [&](const at::Tensor& of_all) {
      return scenes.size() == 1 ? of_all : of_all.narrow(0, rows.begin, rows.count);
    };
    Embedding& embedding = batch.scenes[i];
    embedding.position = own(plan.position);
    embedding.spacing = plan.spacing[i];
    embedding.features = own(batch.features);
    if (normal.defined()) embedding.normal = own(normal);
  }
  return batch;
}

Embedding LightTransportModelImpl::encode(const PointSet& points, uint64_t order_seed,
                                          const Frame& frame, EncoderAttention* attention) {
  Embedding embedding;
  if (attention == nullptr) {
    embedding = encode(std::vector{points}, {order_seed}, frame, nullptr).scenes[0];
  } else {
    *attention = {};
    AttentionRecorder recorder(attention);
    embedding = encode(std::vector{points}, {order_seed}, frame, &recorder).scenes[0];
    attention->normal = points.normal.index_select(0, attention->scene_point);
  }
  if (!at::GradMode::is_enabled() && embedding.features.scalar_type() == at::kFloat) {
    embedding.table = parts_->decoder->table(embedding.features);
  }
  return embedding;
}

SceneBatch LightTransportModelImpl::encode_batch(const std::vector<PointSet>& scenes,
                                                 const std::vector<uint64_t>& order_seeds) {
  return encode(scenes, order_seeds, {}, nullptr);
}

std::vector<StageHealth> LightTransportModelImpl::stage_health(const PointSet& points) {
  const at::NoGradGuard no_grad;
  StageRecorder recorder;
  encode(std::vector{points}, {0}, {}, &recorder);
  return recorder.stages();
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

DecoderReading LightTransportModelImpl::read(const Embedding& embedding, const QuerySet& queries) {
  check_queries(queries);
  const at::NoGradGuard no_grad;
  const Parts::Asked asked = Parts::ask(embedding, queries);
  DecoderReading reading =
      parts_->decoder->read(asked.attributes, asked.queries, embedding.features);
  if (asked.light.defined()) reading.answer = asked.light * reading.answer;
  return reading;
}

at::Tensor LightTransportModelImpl::decode_normalized(const Embedding& embedding,
                                                      const QuerySet& queries) {
  check_queries(queries);
  if (!at::GradMode::is_enabled() && embedding.table.defined()) {
    return parts_->decode(embedding, queries);
  }
  return parts_->decode({embedding}, {queries},
                        parts_->decoder->latent_tables(embedding.features))[0];
}

std::vector<at::Tensor> LightTransportModelImpl::decode_normalized(
    const SceneBatch& batch, const std::vector<QuerySet>& queries) {
  TORCH_CHECK(queries.size() == batch.scenes.size(), "decode: queries of ", queries.size(),
              " scenes for ", batch.scenes.size());
  for (const QuerySet& each : queries) check_queries(each);
  return parts_->decode(batch.scenes, queries, parts_->decoder->latent_tables(batch.features));
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
  LatentTables latents;
  if (!embedding.table.defined()) latents = parts_->decoder->latent_tables(embedding.features);
  const bool fused = embedding.table.defined() && !is_training();
  const bool ordered = fused && queries.position.device().is_cpu();
  const int64_t fast = fused ? kTableBlock : kQueryBlock;
  const int64_t size = options.block > 0 ? std::min(options.block, fast) : fast;
  for (int64_t begin = 0; begin < Q; begin += size) {
    const int64_t count = std::min(size, Q - begin);
    const QuerySet block = {queries.position.narrow(0, begin, count),
                            queries.normal.narrow(0, begin, count),
                            queries.albedo.narrow(0, begin, count)};
    out.narrow(0, begin, count)
        .copy_(ordered                     ? parts_->decode_ordered(embedding, block)
               : embedding.table.defined() ? parts_->decode(embedding, block)
                                           : parts_->decode({embedding}, {block}, latents)[0]);
  }
  for (int64_t c = 0; c < 3; ++c) {  // by number: a tensor's way to a GPU would be waited for
    out.select(1, c).mul_(embedding.emission_scale[c].item<double>());
  }
  return out;
}

}  // namespace lte::nn
