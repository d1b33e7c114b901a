#include "lte/c_api/network.h"

#include <algorithm>
#include <cstring>
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

/// Zeros where `mask` is false, so that what is there is not looked at.
nn::QuerySet masked(const nn::QuerySet& queries, const at::Tensor& mask) {
  const at::Tensor keep = mask.unsqueeze(1);
  return {at::where(keep, queries.position, 0), at::where(keep, queries.normal, 0),
          at::where(keep, queries.albedo, 0)};
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

runtime::SceneEmbedding encode(const runtime::Network& network, const lte_scene_points& points,
                               c10::Device memory) {
  runtime::EncodeOptions options;
  options.rescale = points.rescale != 0;
  const nn::PointSet set = borrow_points(points, memory);
  if (points.origin != nullptr) {
    check_finite_triple(points.origin, "scene points: origin");
    options.origin = {points.origin[0], points.origin[1], points.origin[2]};
  }
  return runtime::SceneEmbedding::from_tensors(network, set, options);
}

void decode(const runtime::SceneEmbedding& scene, const lte_queries& q, c10::Device memory,
            float* irradiance, int64_t stride) {
  require(q.count >= 0, "queries: count is ", q.count, ", expected 0 or more");
  require((q.flags & ~LTE_QUERIES_TRUSTED) == 0, "queries: unknown flags ", q.flags);
  if (q.count == 0) return;
  const at::Tensor out = borrow_output(irradiance, stride, q.count, memory, "irradiance");
  const nn::QuerySet set = borrow_queries(q, memory);
  const bool check = (q.flags & LTE_QUERIES_TRUSTED) == 0;
  if (q.mask == nullptr) {
    out.copy_(scene.decode_tensors(set, {check}));
    return;
  }
  // Rows that the mask leaves out are neither looked at nor decoded.
  const at::Tensor mask = read_mask(q.mask, q.mask_stride, q.count, memory);
  if (check) nn::check_queries(masked(set, mask));
  const at::Tensor rows = mask.nonzero().view({-1});
  const at::Tensor answer = scene.decode_tensors(rows_of(set, rows), {false});
  out.zero_();
  out.index_copy_(0, rows, answer.to(memory));
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
