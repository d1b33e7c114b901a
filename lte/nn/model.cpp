#include "lte/nn/model.h"

#include <algorithm>
#include <cmath>

#include "lte/nn/constants.h"
#include "lte/nn/nearest_neighbour_embedding.h"
#include "lte/nn/point_transformer.h"
#include "lte/nn/query_decoder.h"
#include "lte/ops/query_decoder.h"

namespace lte::nn {
namespace {

/// Queries decoded at a time. By the fused operator their neighbours are all that is kept, 50 MB;
/// else the intermediates are some 60 MB at D = 128 and stay in the outer caches' reach.
constexpr int64_t kTableBlock = int64_t{1} << 17, kQueryBlock = 4096;

/// @throws c10::Error unless `t` is [rows, 3] or [rows], and every value finite, naming the first
/// row that is not.
void check_rows(const at::Tensor& t, int64_t rows, bool triple, const char* what,
                const char* name) {
  const bool shape_ok = t.defined() && t.dim() == (triple ? 2 : 1) && t.size(0) == rows &&
                        (!triple || t.size(1) == 3);
  TORCH_CHECK(shape_ok, what, ": ", name, " must be [", rows, triple ? ", 3]" : "]", ", got ",
              t.defined() ? c10::str(t.sizes()) : std::string("nothing"));
  const at::Tensor finite = triple ? t.isfinite().all(1) : t.isfinite();
  if (finite.all().item<bool>()) return;
  const int64_t row = finite.logical_not().nonzero()[0][0].item<int64_t>();
  TORCH_CHECK(false, what, ": ", name, " of row ", row, " is not finite");
}

/// @throws c10::Error naming the first row with a value outside [low, high].
void check_range(const at::Tensor& t, double low, double high, const char* what, const char* name) {
  const at::Tensor bad = (t < low).logical_or(t > high);
  if (!bad.any().item<bool>()) return;
  const int64_t row = bad.nonzero()[0][0].item<int64_t>();
  TORCH_CHECK(false, what, ": ", name, " of row ", row, " is outside [", low, ", ", high, "]");
}

void check_surface(const at::Tensor& position, const at::Tensor& normal, const at::Tensor& albedo,
                   const char* what) {
  TORCH_CHECK(position.defined() && position.dim() == 2, what, ": position must be [N, 3]");
  const int64_t rows = position.size(0);
  check_rows(position, rows, true, what, "position");
  check_rows(normal, rows, true, what, "normal");
  check_rows(albedo, rows, true, what, "albedo");
  check_range(normal, -1.01, 1.01, what, "normal");
  check_range(albedo, 0, 16, what, "albedo");
}

void check_points(const PointSet& points) {
  check_surface(points.position, points.normal, points.albedo, "scene points");
  const int64_t rows = points.position.size(0);
  TORCH_CHECK(rows >= 1, "scene points: there are none");
  check_rows(points.emission, rows, true, "scene points", "emission");
  check_rows(points.area, rows, false, "scene points", "area");
  check_range(points.emission, 0, INFINITY, "scene points", "emission");
  check_range(points.area, 0, INFINITY, "scene points", "area");
}

void check_light(const at::Tensor& irradiance, const PointSet& points, const char* name) {
  TORCH_CHECK(irradiance.defined(), "scene points: ", name, " is missing, which this model reads");
  check_rows(irradiance, points.position.size(0), true, "scene points", name);
  check_range(irradiance, 0, INFINITY, "scene points", name);
}

/// log(1 + light/a) by channel: emission over its mean spans four decades, from dim panels to bare
/// bulbs, and direct irradiance as many.
at::Tensor compressed(const at::Tensor& light, const at::Tensor& radiance) {
  const at::Tensor a = radiance.to(light.device());
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

  /// [Q, 3] over the emission scalar. Give either the table or keys and values.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries, const at::Tensor& keys,
                    const at::Tensor& values) {
    const at::Tensor position = (queries.position - embedding.origin).div(embedding.scale);
    const at::Tensor attributes = surface_attributes(position, queries.normal, queries.albedo);
    if (!embedding.cache.defined()) return answers(embedding, attributes, position, keys, values);
    const LightReading light = embedding.cache.read(position, queries.normal);
    return light.irradiance *
           answers(embedding, at::cat({attributes, light.features}, 1), position, keys, values);
  }

  /// What the network says: irradiance, or the factor on that of the cache.
  at::Tensor answers(const Embedding& embedding, const at::Tensor& attributes,
                     const at::Tensor& position, const at::Tensor& keys, const at::Tensor& values) {
    if (!keys.defined()) {
      return decoder->infer(attributes, position, embedding.position, embedding.spacing,
                            embedding.table);
    }
    const auto near = decoder->neighbourhood(position, embedding.position, embedding.spacing);
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

void check_queries(const QuerySet& queries) {
  check_surface(queries.position, queries.normal, queries.albedo, "query points");
}

at::Tensor channel_radiance(const PointSet& points) {
  const at::Tensor emission = points.emission.to(at::kDouble);
  const at::Tensor area = points.area.to(at::kDouble);
  const double total_area = area.sum().item<double>();
  const at::Tensor mean =
      total_area > 0 ? at::mv(emission.t(), area).div(total_area) : emission.mean(0);
  return mean.to(at::kCPU);
}

double radiance_scalar(const PointSet& points) {
  const double mean = channel_radiance(points).mean().item<double>();
  return mean > 0 ? mean : 1;
}

LightTransportModelImpl::LightTransportModelImpl(const ModelConfig& config)
    : config_(config), parts_(std::make_shared<Parts>()) {
  const int64_t latent =
      config.channels *
      (config.decoder_widths.empty() ? config.encoder_widths[0] : config.decoder_widths[0]);
  parts_->nne =
      register_module("nne", NearestNeighbourEmbedding(config.point_inputs(), config.channels));
  parts_->encoder = register_module("encoder", PointTransformer(config));
  parts_->decoder = register_module("decoder", QueryDecoder(latent, config));
}

Embedding LightTransportModelImpl::encode(const PointSet& points, uint64_t order_seed,
                                          const Frame& frame) {
  check_points(points);
  if (config_.reads_direct()) check_light(points.direct, points, "direct irradiance");
  if (config_.reads_indirect()) check_light(points.indirect, points, "indirect irradiance");
  Embedding embedding;
  embedding.scale = frame.scale > 0 ? frame.scale : config_.scale;
  embedding.origin = frame.origin.defined() ? frame.origin.to(points.position.options())
                                            : std::get<0>(points.position.min(0));
  const at::Tensor position = (points.position - embedding.origin).div(embedding.scale);
  const double extent = position.max().item<double>();
  TORCH_CHECK(extent <= kLargestPosition, "scene points: the scene is ", extent * embedding.scale,
              " m wide, more than the model's scale of ", embedding.scale,
              " m; --rescale shrinks it to fit");
  TORCH_CHECK(!frame.origin.defined() || position.min().item<double>() >= 0,
              "scene points: a position is less than the given least corner of the scene, ",
              embedding.origin[0].item<double>(), ", ", embedding.origin[1].item<double>(), ", ",
              embedding.origin[2].item<double>());
  embedding.radiance = channel_radiance(points);

  const EncoderPlan plan =
      make_encoder_plan(position.to(at::kFloat).contiguous(), config_, is_training(), order_seed);
  std::vector<at::Tensor> attributes = {surface_attributes(position, points.normal, points.albedo),
                                        compressed(points.emission, embedding.radiance)};
  if (config_.reads_direct()) attributes.push_back(compressed(points.direct, embedding.radiance));
  if (config_.reads_indirect())
    attributes.push_back(compressed(points.indirect, embedding.radiance));
  embedding.position = plan.position;
  embedding.spacing = plan.spacing;
  embedding.features =
      parts_->encoder->forward(parts_->nne->forward(at::cat(attributes, 1), plan), plan);
  if (config_.reads_indirect()) {
    const at::Tensor a = embedding.radiance.to(points.indirect.options());
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
  if (embedding.radiance.max().item<double>() == 0) return at::zeros_like(queries.position);
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
    out.select(1, c).mul_(embedding.radiance[c].item<double>());
  }
  return out;
}

ParameterCounts count_parameters(const LightTransportModel& model) {
  ParameterCounts counts;
  for (const auto& item : model->named_parameters()) {
    const int64_t n = item.value().numel();
    counts.total += n;
    if (item.key().rfind("nne.", 0) == 0) counts.nne += n;
    if (item.key().rfind("encoder.", 0) == 0) counts.encoder += n;
    if (item.key().rfind("decoder.", 0) == 0) counts.decoder += n;
  }
  return counts;
}

}  // namespace lte::nn
