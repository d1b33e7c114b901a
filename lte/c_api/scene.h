// Scenes and queries of a C program, as lte::runtime takes them.
#pragma once

#include <cstdint>

#include "lte/c_api.h"
#include "lte/runtime/embedding.h"

namespace lte::c_api {

lte_embedding_info info_of(const runtime::SceneEmbedding& scene);

/// Whether a model needs the points' areas in m², not only their ratios: light that is solved on
/// the points, and the discs that rays meet, have the size that they say.
bool needs_area(const runtime::ModelConfig& config);

/// @param memory  where the arrays of `points` are
/// @throws ApiError, lte::Error
runtime::SceneEmbedding encode(const runtime::Network& network, const lte_scene_points& points,
                               runtime::Device memory);

/// @param memory  where the arrays of `queries` and `irradiance` are
/// @throws ApiError, lte::Error
void decode(const runtime::SceneEmbedding& scene, const lte_queries& queries,
            runtime::Device memory, float* irradiance, int64_t stride);

/// As many directions of each query.
struct Directions {
  const lte_float3_view* triples;
  int64_t a_query;
};

/// @param memory  where the arrays of `queries`, `directions` and `radiance` are
/// @throws ApiError, lte::Error
void decode_radiance(const runtime::SceneEmbedding& scene, const lte_queries& queries,
                     const Directions& directions, runtime::Device memory, float* radiance,
                     int64_t stride);

/// @param scene  what the caller says of the scene, printable ASCII; null: nothing
/// @throws ApiError, lte::Error
void save(const runtime::SceneEmbedding& embedding, const char* path, const char* scene);
runtime::SceneEmbedding load(const runtime::Network& network, const char* path, const char* scene);

/// @throws ApiError unless the three are finite and not negative.
void set_gain(runtime::SceneEmbedding* scene, const float* rgb);

}  // namespace lte::c_api
