#include "lte/nn/model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lte/nn/constants.h"
#include "lte/nn/cost.h"
#include "lte/nn/encoder/attention_record.h"
#include "lte/nn/model_parts.h"

namespace lte::nn {
namespace {

/// log(1 + light/a) by channel: emission over its mean spans four decades, from dim panels to bare
/// bulbs, and direct irradiance as many.
at::Tensor compressed(const at::Tensor& light, const at::Tensor& emission_scale) {
  const at::Tensor a = emission_scale.to(light.device());
  return at::log1p(light.to(at::kDouble).div(at::where(a > 0, a, 1))).to(light.scalar_type());
}

/// The columns of F for gloss: how metallic a point is, and that times how smooth, so that what is
/// no metal reads the same however rough it is said to be.
at::Tensor gloss_columns(const PointSet& points) {
  if (!points.gloss.defined())
    return at::zeros({points.position.size(0), 2}, points.position.options());
  const at::Tensor metallic = points.gloss.narrow(1, 0, 1),
                   roughness = points.gloss.narrow(1, 1, 1);
  return at::cat({metallic, metallic * (1 - roughness)}, 1);
}

}  // namespace

LightTransportModelImpl::LightTransportModelImpl(const ModelConfig& config)
    : config_(config), parts_(std::make_shared<Parts>()) {
  parts_->nne =
      register_module("nne", NearestNeighbourEmbedding(config.point_inputs(), config.channels));
  parts_->encoder = register_module("encoder", PointTransformer(config));
  parts_->decoder = register_module("decoder", QueryDecoder(latent_width(config), config));
  if (config.predicts_radiance())
    parts_->radiance = register_module("radiance", RadianceDecoder(latent_width(config), config));
}

void LightTransportModelImpl::make_tables(Embedding* embedding) {
  if (!embedding->table.defined()) embedding->table = parts_->decoder->table(embedding->features);
  if (config_.predicts_radiance())
    embedding->radiance_table = parts_->radiance->query()->table(embedding->features);
  if (!embedding->features.is_cpu()) return;
  embedding->nearest = parts_->decoder->index(embedding->position);
  embedding->weights = parts_->decoder->packed();
  if (config_.predicts_radiance())
    embedding->radiance_weights = parts_->radiance->query()->packed();
  if (embedding->prior.defined() && !embedding->prior.nearest) embedding->prior.make_index();
}

/// The columns of F for the light on scene points, and the prior made of it.
void LightTransportModelImpl::add_light(const PointSet& points, const at::Tensor& position,
                                        std::vector<at::Tensor>* columns,
                                        Embedding* embedding) const {
  if (!config_.reads_light()) return;
  using Sides = std::array<at::Tensor, 2>;
  const Sides direct = {points.direct - points.direct_back, points.direct_back},
              indirect = {points.indirect - points.indirect_back, points.indirect_back};
  for (const Sides* light : {&direct, &indirect}) {
    for (const at::Tensor& side : *light)
      columns->push_back(compressed(side, embedding->emission_scale));
  }
  const at::Tensor a = embedding->emission_scale.to(points.indirect.options());
  const at::Tensor scale = at::where(a > 0, a, 1).repeat({2});
  const auto of_side = [&](size_t side) {
    return at::cat({indirect[side], direct[side]}, 1).div(scale);
  };
  const at::Tensor error = config_.reads_estimates() ? points.indirect_error : at::Tensor();
  if (error.defined()) columns->push_back(error);
  embedding->prior = make_light_prior(position, points.normal, points.emission,
                                      at::cat({of_side(0), of_side(1)}, 1), error);
}

/// A scene's place in network space and the scale of its light. The columns of F for its points go
/// to `attributes`, their positions to `position`.
Embedding LightTransportModelImpl::place(const PointSet& points, const Frame& frame, Values values,
                                         at::Tensor* position, at::Tensor* attributes) const {
  if (values == Values::Checked) check_points(points, config_);
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
  if (config_.predicts_radiance()) columns.push_back(gloss_columns(points));
  *attributes = at::cat(columns, 1);
  return embedding;
}

/// The discs that rays see, without gradients. Outside training the table that this makes stays.
void LightTransportModelImpl::add_surfels(const PointSet& points, const at::Tensor& position,
                                          Embedding* embedding) {
  const bool keeps_table = !at::GradMode::is_enabled();
  const at::NoGradGuard no_grad;
  QueryDecoder& decoder = parts_->decoder;
  const bool was_training = decoder->is_training();
  decoder->eval();  // the operator of inference, whatever is trained
  Embedding frozen = *embedding;
  frozen.features = embedding->features.detach();
  const QuerySet fronts{points.position, points.normal, points.albedo};
  const bool fused = frozen.features.scalar_type() == at::kFloat;
  if (fused) frozen.table = decoder->table(frozen.features);
  const at::Tensor irradiance =
      fused ? parts_->decode_ordered(frozen, fronts)
            : parts_->decode({frozen}, {fronts}, decoder->latent_tables(frozen.features))[0];
  decoder->train(was_training);
  if (keeps_table) embedding->table = frozen.table;
  embedding->surfels =
      make_surfels(points, position, embedding->scale, embedding->emission_scale, irradiance);
}

SceneBatch LightTransportModelImpl::encode(const std::vector<PointSet>& scenes,
                                           const std::vector<uint64_t>& order_seeds,
                                           const Frame& frame, EncoderRecorder* recorder,
                                           Values values) {
  SceneBatch batch;
  std::vector<at::Tensor> positions, attributes, normals;
  for (const PointSet& points : scenes) {
    at::Tensor position, columns;
    batch.scenes.push_back(place(points, frame, values, &position, &columns));
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
    if (config_.predicts_radiance()) add_surfels(scenes[i], positions[i], &embedding);
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
    make_tables(&embedding);
  }
  return embedding;
}

SceneBatch LightTransportModelImpl::encode_batch(const std::vector<PointSet>& scenes,
                                                 const std::vector<uint64_t>& order_seeds,
                                                 Values values) {
  return encode(scenes, order_seeds, {}, nullptr, values);
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
  const Parts::Input input = Parts::input_of(embedding, queries);
  DecoderReading reading =
      parts_->decoder->read(input.attributes, input.queries, embedding.features);
  if (input.light.defined()) reading.answer = input.light * reading.answer;
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
    const SceneBatch& batch, const std::vector<QuerySet>& queries, Values values) {
  TORCH_CHECK(queries.size() == batch.scenes.size(), "decode: queries of ", queries.size(),
              " scenes for ", batch.scenes.size());
  if (values == Values::Checked) {
    for (const QuerySet& each : queries) check_queries(each);
  }
  return parts_->decode(batch.scenes, queries, parts_->decoder->latent_tables(batch.features));
}

at::Tensor LightTransportModelImpl::decode(const Embedding& embedding, const QuerySet& queries,
                                           const DecodeOptions& options) {
  TORCH_CHECK(options.block >= 0, "decode: blocks of ", options.block, " queries");
  const at::NoGradGuard no_grad;
  if (options.check_values) check_queries(queries);
  const int64_t Q = queries.position.size(0);
  if (is_dark(embedding.emission_scale)) return at::zeros_like(queries.position);
  LatentTables latents;
  if (!embedding.table.defined()) latents = parts_->decoder->latent_tables(embedding.features);
  const bool fused = embedding.table.defined() && !is_training();
  const int64_t fast = fused ? kTableBlock : kQueryBlock;
  const int64_t size = options.block > 0 ? std::min(options.block, fast) : fast;
  const auto answer = [&](const QuerySet& block) {
    return fused                       ? parts_->decode_ordered(embedding, block)
           : embedding.table.defined() ? parts_->decode(embedding, block)
                                       : parts_->decode({embedding}, {block}, latents)[0];
  };
  at::Tensor out;
  if (Q > 0 && Q <= size) {
    out = answer(queries);
  } else {
    out = at::empty({Q, 3}, embedding.features.options());
    for (int64_t begin = 0; begin < Q; begin += size) {
      const int64_t count = std::min(size, Q - begin);
      out.narrow(0, begin, count).copy_(answer(block_of(queries, begin, count)));
    }
  }
  scale_channels(embedding.emission_scale, 1, &out);
  return out;
}

}  // namespace lte::nn
