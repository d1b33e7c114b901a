#include "lte/c_api/scene.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "lte/c_api/arguments.h"
#include "lte/runtime/embedding_file.h"

namespace lte::c_api {
namespace {

constexpr size_t kSceneName = 1000;  ///< bytes of what names a scene in a file

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

bool needs_area(const runtime::ModelConfig& config) {
  return config.solves_light() || config.predicts_radiance();
}

runtime::SceneEmbedding encode(const runtime::Network& network, const lte_scene_points& points,
                               runtime::Device memory) {
  runtime::EncodeOptions options;
  options.rescale = points.rescale != 0;
  require(points.area != nullptr || !needs_area(network.config()),
          "scene points: area is null, but this model needs it (lte_model_info::needs_area)");
  const runtime::ScenePointsIn in = read_points(points, memory);
  if (points.origin != nullptr) {
    check_finite_triple(points.origin, "scene points: origin");
    options.origin = {points.origin[0], points.origin[1], points.origin[2]};
  }
  return runtime::encode(network, in, options);
}

void decode(const runtime::SceneEmbedding& scene, const lte_queries& q, runtime::Device memory,
            float* irradiance, int64_t stride) {
  const runtime::QueriesIn queries = read_queries(q, memory);
  if (q.count == 0) return;
  runtime::decode(scene, queries, read_output(irradiance, stride, q.count, "irradiance"));
}

void decode_radiance(const runtime::SceneEmbedding& scene, const lte_queries& q,
                     const Directions& directions, runtime::Device memory, float* radiance,
                     int64_t stride) {
  const int64_t each = directions.a_query;
  require(scene.network().config().predicts_radiance(),
          "the model predicts no radiance: its lte_model_info::predicts_radiance is 0");
  const runtime::QueriesIn queries = read_queries(q, memory);
  require(directions.triples != nullptr, "directions is null");
  require(each >= 1, "directions_a_query is ", each, ", expected at least 1");
  require(q.count <= std::numeric_limits<int64_t>::max() / each, "directions: ", q.count, " times ",
          each, " are more than there are addresses");
  if (q.count == 0) return;
  const int64_t all = q.count * each;
  const runtime::TriplesIn ways = read_triples(*directions.triples, all, "directions");
  runtime::decode_radiance(scene, queries, ways, each,
                           read_output(radiance, stride, all, "radiance"));
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
