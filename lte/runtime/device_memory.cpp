#include "lte/runtime/device_memory.h"

#include <cmath>

#include "lte/nn/model.h"
#include "lte/runtime/torch_errors.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"

namespace lte::runtime {
namespace {

at::TensorOptions floats_on(Device memory) {
  return at::TensorOptions(at::kFloat).device(torch_device(memory));
}

/// [count, 3] that borrows the memory; undefined for null.
at::Tensor borrowed(const TriplesIn& triples, int64_t count, Device memory) {
  if (triples.data == nullptr) return {};
  return at::from_blob(const_cast<float*>(triples.data), {count, 3},
                       {triples.stride / static_cast<int64_t>(sizeof(float)), 1},
                       floats_on(memory));
}

at::Tensor borrowed(const TriplesOut& triples, int64_t count, Device memory) {
  return borrowed(TriplesIn{triples.data, triples.stride}, count, memory);
}

/// [count, 2], likewise.
at::Tensor borrowed_pairs(const float* data, int64_t count, Device memory) {
  if (data == nullptr) return {};
  return at::from_blob(const_cast<float*>(data), {count, 2}, floats_on(memory));
}

nn::PointSet borrowed(const ScenePointsIn& p) {
  const auto triples = [&](const TriplesIn& in) { return borrowed(in, p.count, p.memory); };
  nn::PointSet points;
  points.position = triples(p.position);
  points.normal = triples(p.normal);
  points.albedo = triples(p.albedo);
  points.emission = triples(p.emission);
  points.area = p.area == nullptr
                    ? at::ones({p.count}, floats_on(p.memory))
                    : at::from_blob(const_cast<float*>(p.area), {p.count}, floats_on(p.memory));
  points.direct = triples(p.direct);
  points.indirect = triples(p.indirect);
  points.direct_back = triples(p.direct_back);
  points.indirect_back = triples(p.indirect_back);
  points.indirect_error = borrowed_pairs(p.indirect_error, p.count, p.memory);
  points.gloss = borrowed_pairs(p.gloss, p.count, p.memory);
  return points;
}

nn::QuerySet borrowed(const QueriesIn& q) {
  const auto triples = [&](const TriplesIn& in) { return borrowed(in, q.count, q.memory); };
  return {triples(q.position), triples(q.normal), triples(q.albedo)};
}

/// Queries that are asked for irradiance, or for radiance from directions of theirs.
struct Request {
  nn::QuerySet queries;
  at::Tensor directions = {};  ///< [N, D, 3]; undefined: irradiance

  Request rows(const at::Tensor& index) const {
    const auto of = [&](const at::Tensor& all) { return all.index_select(0, index); };
    return {{of(queries.position), of(queries.normal), of(queries.albedo)},
            directions.defined() ? of(directions) : at::Tensor()};
  }
  /// Values that are fine where `mask` is false, so that what is there is not looked at.
  Request masked(const at::Tensor& mask) const {
    const at::Tensor keep = mask.unsqueeze(1);
    Request out{{at::where(keep, queries.position, 0), at::where(keep, queries.normal, 0),
                 at::where(keep, queries.albedo, 0)}};
    // Of length 1, and not below the surface with the normal 0.
    if (directions.defined())
      out.directions = at::where(keep.unsqueeze(2), directions, std::sqrt(1 / 3.0));
    return out;
  }
  void check() const {
    nn::check_queries(queries);
    if (directions.defined()) nn::check_directions(queries, directions);
  }
  at::Tensor answer(const SceneEmbedding& embedding, bool check) const {
    const nn::DecodeOptions options{check};
    return directions.defined()
               ? TorchParts::decode_radiance(embedding, queries, directions, options)
               : TorchParts::decode(embedding, queries, options);
  }
};

/// Writes the answers to `out`, whose first axis is the queries.
void answer(const SceneEmbedding& embedding, const QueriesIn& q, const Request& request,
            const at::Tensor& out) {
  if (q.mask == nullptr) {
    out.copy_(request.answer(embedding, !q.trusted));
    return;
  }
  // Rows that the mask leaves out are neither looked at nor decoded.
  const at::Tensor mask = at::from_blob(const_cast<uint8_t*>(q.mask), {q.count}, {q.mask_stride},
                                        at::TensorOptions(at::kByte).device(out.device()))
                              .ne(0);
  if (!q.trusted) request.masked(mask).check();
  const at::Tensor rows = mask.nonzero().view({-1});
  const at::Tensor answers = request.rows(rows).answer(embedding, false);
  out.zero_();
  out.index_copy_(0, rows, answers.to(out.device()));
}

}  // namespace

SceneEmbedding encode(const Network& network, const ScenePointsIn& points,
                      const EncodeOptions& options) {
  return own_errors([&] { return TorchParts::encode(network, borrowed(points), options); });
}

void decode(const SceneEmbedding& embedding, const QueriesIn& queries,
            const TriplesOut& irradiance) {
  if (queries.count == 0) return;
  own_errors([&] {
    answer(embedding, queries, {borrowed(queries)},
           borrowed(irradiance, queries.count, queries.memory));
  });
}

void decode_radiance(const SceneEmbedding& embedding, const QueriesIn& queries,
                     const TriplesIn& directions, int64_t each, const TriplesOut& radiance) {
  if (queries.count == 0) return;
  own_errors([&] {
    const auto rows = [&](const at::Tensor& all) { return all.view({queries.count, each, 3}); };
    const int64_t all = queries.count * each;
    answer(embedding, queries, {borrowed(queries), rows(borrowed(directions, all, queries.memory))},
           rows(borrowed(radiance, all, queries.memory)));
  });
}

}  // namespace lte::runtime
