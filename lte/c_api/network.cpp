#include "lte/c_api/network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <ATen/ATen.h>

#include "lte/c_api/arguments.h"
#include "lte/nn/model.h"
#include "lte/runtime/embedding_file.h"

namespace lte::c_api {
namespace {

constexpr size_t kSceneName = 1000;  ///< bytes of what names a scene in a file

nn::QuerySet rows_of(const nn::QuerySet& queries, const at::Tensor& rows) {
  return {queries.position.index_select(0, rows), queries.normal.index_select(0, rows),
          queries.albedo.index_select(0, rows)};
}

/// What the caller says of the scene, as an entry of the file.
runtime::EmbeddingKey key_of(const char* scene) {
  if (scene == nullptr) return {};
  const size_t length = strnlen(scene, kSceneName + 1);
  require(length <= kSceneName, "scene is longer than ", kSceneName, " bytes");
  const std::string text(scene, length);
  for (const char c : text)
    require(c >= ' ' && c <= '~', "scene has a byte that is no printable ASCII");
  return {{"scene", text}};
}

/// Queries that are asked for irradiance, or for radiance from directions of theirs.
struct Asked {
  nn::QuerySet queries;
  at::Tensor directions = {};  ///< [N, D, 3]; undefined: irradiance

  Asked rows(const at::Tensor& index) const {
    return {rows_of(queries, index),
            directions.defined() ? directions.index_select(0, index) : at::Tensor()};
  }
  /// Values that are fine where `mask` is false, so that what is there is not looked at.
  Asked masked(const at::Tensor& mask) const {
    const at::Tensor keep = mask.unsqueeze(1);
    Asked out{{at::where(keep, queries.position, 0), at::where(keep, queries.normal, 0),
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
  at::Tensor answer(const runtime::SceneEmbedding& scene, const nn::DecodeOptions& options) const {
    return directions.defined() ? scene.decode_radiance_tensors(queries, directions, options)
                                : scene.decode_tensors(queries, options);
  }
};

/// Writes the answers to `out`, whose first axis is the queries.
void answer(const runtime::SceneEmbedding& scene, const lte_queries& q, const Asked& asked,
            c10::Device memory, const at::Tensor& out) {
  const bool check = (q.flags & LTE_QUERIES_TRUSTED) == 0;
  if (q.mask == nullptr) {
    out.copy_(asked.answer(scene, {check}));
    return;
  }
  // Rows that the mask leaves out are neither looked at nor decoded.
  const at::Tensor mask = read_mask(q.mask, q.mask_stride, q.count, memory);
  if (check) asked.masked(mask).check();
  const at::Tensor rows = mask.nonzero().view({-1});
  const at::Tensor answers = asked.rows(rows).answer(scene, {false});
  out.zero_();
  out.index_copy_(0, rows, answers.to(memory));
}

void check_header(const lte_queries& q) {
  require(q.count >= 0, "queries: count is ", q.count, ", expected 0 or more");
  require((q.flags & ~LTE_QUERIES_TRUSTED) == 0, "queries: unknown flags ", q.flags);
}

}  // namespace

lte_embedding_info info_of(const runtime::SceneEmbedding& scene) {
  const runtime::EmbeddingInfo from = scene.info();
  lte_embedding_info info = {};
  info.scene_points = from.scene_points;
  info.latents = from.latents;
  info.bytes = from.bytes;
  std::copy(from.origin.begin(), from.origin.end(), info.origin);
  info.scale = from.scale;
  std::copy(from.emission.begin(), from.emission.end(), info.radiance);
  return info;
}

bool needs_area(const nn::ModelConfig& config) {
  return config.solves_light() || config.casts_rays();
}

runtime::SceneEmbedding encode(const runtime::Network& network, const lte_scene_points& points,
                               c10::Device memory) {
  runtime::EncodeOptions options;
  options.rescale = points.rescale != 0;
  require(points.area != nullptr || !needs_area(network.config()),
          "scene points: area is null, but this model needs it (lte_model_info::needs_area)");
  const nn::PointSet set = borrow_points(points, memory);
  if (points.origin != nullptr) {
    check_finite_triple(points.origin, "scene points: origin");
    options.origin = {points.origin[0], points.origin[1], points.origin[2]};
  }
  return runtime::SceneEmbedding::from_tensors(network, set, options);
}

void decode(const runtime::SceneEmbedding& scene, const lte_queries& q, c10::Device memory,
            float* irradiance, int64_t stride) {
  check_header(q);
  if (q.count == 0) return;
  const at::Tensor out = borrow_output(irradiance, stride, q.count, memory, "irradiance");
  answer(scene, q, {borrow_queries(q, memory)}, memory, out);
}

void decode_radiance(const runtime::SceneEmbedding& scene, const lte_queries& q,
                     const Directions& directions, c10::Device memory, float* radiance,
                     int64_t stride) {
  const int64_t each = directions.a_query;
  require(scene.network().config().predicts_radiance(),
          "the model predicts no radiance: its lte_model_info::predicts_radiance is 0");
  check_header(q);
  require(directions.triples != nullptr, "directions is null");
  require(each >= 1, "directions_a_query is ", each, ", expected at least 1");
  require(q.count <= std::numeric_limits<int64_t>::max() / each, "directions: ", q.count, " times ",
          each, " are more than there are addresses");
  if (q.count == 0) return;
  const int64_t all = q.count * each;
  const std::array<int64_t, 3> shape = {q.count, each, 3};
  const at::Tensor out = borrow_output(radiance, stride, all, memory, "radiance").view(shape),
                   ways =
                       borrow_triples(*directions.triples, all, memory, "directions").view(shape);
  answer(scene, q, {borrow_queries(q, memory), ways}, memory, out);
}

void save(const runtime::SceneEmbedding& embedding, const char* path, const char* scene) {
  runtime::save_embedding(path, embedding, key_of(scene));
}

runtime::SceneEmbedding load(const runtime::Network& network, const char* path, const char* scene) {
  return runtime::load_embedding(path, network, key_of(scene));
}

void set_gain(runtime::SceneEmbedding* scene, const float* rgb) {
  check_finite_triple(rgb, "emission gain");
  for (int i = 0; i < 3; ++i) require(rgb[i] >= 0, "emission gain[", i, "] is negative: ", rgb[i]);
  scene->set_emission_gain({rgb[0], rgb[1], rgb[2]});
}

}  // namespace lte::c_api
