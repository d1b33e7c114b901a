#include <algorithm>
#include <numbers>

#include "lte/nn/model_parts.h"

namespace lte::nn {
namespace {

/// Directions that are decoded at a time: their lobes are 32 MB at 64 a point.
constexpr int64_t kDirectionBlock = int64_t{1} << 17;

void check_radiance(const ModelConfig& config) {
  TORCH_CHECK(config.predicts_radiance(),
              "radiance: the model has no radiance decoder (its model.radiance_lobes is 0)");
}

/// Queries that are taken at a time, at most `most`; 0: as many as run fast.
int64_t query_block(int64_t most, int64_t directions) {
  const int64_t fast = kDirectionBlock / std::max<int64_t>(1, directions);
  return std::max<int64_t>(1, most == 0 ? fast : std::min(most, fast));
}

}  // namespace

std::vector<at::Tensor> LightTransportModelImpl::decode_radiance_normalized(
    const SceneBatch& batch, const std::vector<QuerySet>& queries,
    const std::vector<at::Tensor>& directions) {
  check_radiance(config_);
  TORCH_CHECK(queries.size() == batch.scenes.size() && directions.size() == queries.size(),
              "radiance: queries of ", queries.size(), " scenes and directions of ",
              directions.size(), " for ", batch.scenes.size());
  std::vector<Parts::Input> each;
  std::vector<at::Tensor> seen;
  for (size_t i = 0; i < queries.size(); ++i) {
    check_queries(queries[i]);
    check_directions(queries[i], directions[i]);
    each.push_back(Parts::input_of(batch.scenes[i], queries[i]));
    seen.push_back(batch.scenes[i].surfels.see(each[i].queries.query.position, directions[i]));
  }
  const Parts::BatchInput input = Parts::joined(each);
  QueryDecoder& query = parts_->radiance->query();
  const std::vector<at::Tensor> features =
      query->forward(input.attributes, input.queries, query->latent_tables(batch.features))
          .split_with_sizes(input.counts);
  std::vector<at::Tensor> answers;
  for (size_t i = 0; i < queries.size(); ++i) {
    answers.push_back(
        parts_->radiance->radiance(features[i], directions[i], input.light[i], seen[i]));
  }
  return answers;
}

/// decode_radiance_normalized() of one scene, without gradients.
at::Tensor LightTransportModelImpl::radiance_of_block(const Embedding& embedding,
                                                      const QuerySet& queries,
                                                      const at::Tensor& directions) {
  if (!embedding.radiance_table.defined() || is_training())
    return decode_radiance_normalized({{embedding}, embedding.features}, {queries},
                                      {directions})[0];
  const QueryOrder order(queries.position);
  const Parts::Input input = Parts::input_of(embedding, order.ordered(queries));
  const at::Tensor ways = order.ordered(directions);
  const at::Tensor seen = embedding.surfels.see(input.queries.query.position, ways);
  const at::Tensor features = parts_->radiance->query()->infer(
      input.attributes, input.queries.query, input.queries.anchor, embedding.spacing,
      embedding.radiance_table, {embedding.nearest.get(), embedding.radiance_weights.get()});
  return order.restored(parts_->radiance->radiance(features, ways, input.light, seen));
}

at::Tensor LightTransportModelImpl::decode_radiance(const Embedding& embedding,
                                                    const QuerySet& queries,
                                                    const at::Tensor& directions,
                                                    const DecodeOptions& options) {
  check_radiance(config_);
  TORCH_CHECK(options.block >= 0, "radiance: blocks of ", options.block, " queries");
  const at::NoGradGuard no_grad;
  if (options.check_values) {
    check_queries(queries);
    check_directions(queries, directions);
  }
  const int64_t Q = queries.position.size(0), N = directions.size(1);
  at::Tensor out = at::zeros({Q, N, 3}, embedding.features.options());
  if (is_dark(embedding.emission_scale)) return out;
  const int64_t size = query_block(options.block, N);
  for (int64_t begin = 0; begin < Q; begin += size) {
    const int64_t count = std::min(size, Q - begin);
    out.narrow(0, begin, count)
        .copy_(radiance_of_block(embedding, block_of(queries, begin, count),
                                 directions.narrow(0, begin, count)));
  }
  scale_channels(embedding.emission_scale, std::numbers::inv_pi, &out);
  return out;
}

}  // namespace lte::nn
