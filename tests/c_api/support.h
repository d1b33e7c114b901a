// A small model, a scene and queries as C programs have them, and as the C++ library takes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lte/c_api.h"
#include "lte/runtime/embedding.h"
#include "tests/nn/tiny_model.h"

namespace lte::test {

using Rgbs = std::vector<Rgb>;

/// Random points on the walls of a 4 x 3 x 5 m box, a tenth of them emitting. Positions are
/// multiples of 1/16 m.
struct BoxQueries {
  BoxQueries(int64_t count, uint64_t seed);
  runtime::QueryPoints arrays() const { return {position, normal, albedo}; }
  lte_queries in_c() const;

  std::vector<Vec3> position, normal;
  Rgbs albedo;
};
struct BoxScene : BoxQueries {
  BoxScene(int64_t count, uint64_t seed);
  /// @param light  with the light on the points, its errors, and `gloss`
  runtime::ScenePoints arrays(bool light = false) const;
  lte_scene_points in_c(bool light = false) const;

  Rgbs emission, direct, indirect, direct_back, indirect_back;
  std::vector<float> area, indirect_error, gloss;
};

/// Without gaps.
lte_float3_view view(const std::vector<Vec3>& triples);

/// Saves a network of random weights, once a process.
const std::filesystem::path& tiny_model_file();

/// The tiny model, or that of a file, in C hands; released at the end.
struct Model {
  lte_model* handle = nullptr;
  explicit Model(const std::filesystem::path& file = tiny_model_file());
  ~Model() { lte_model_release(handle); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  lte_model_info info() const;
};

struct Embedding {
  lte_embedding* handle = nullptr;
  Embedding(const lte_model* model, const lte_scene_points& points);
  ~Embedding() { lte_embedding_release(handle); }
  Embedding(const Embedding&) = delete;
  Embedding& operator=(const Embedding&) = delete;
  lte_embedding_info info() const;
};

/// The answers of lte_embedding_decode(); it must succeed.
Rgbs decode(const lte_embedding* embedding, const lte_queries& queries);

/// |a − b| / |b| in the Euclidean norm.
double relative_difference(const Rgbs& a, const Rgbs& b);

/// Each times `gain`.
Rgbs scaled(Rgbs values, const Rgb& gain);

}  // namespace lte::test
