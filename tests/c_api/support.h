// A small model, a scene and queries as C programs have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/c_api.h"
#include "lte/nn/model.h"

namespace lte::test {

/// Saves a network of random weights, once a process.
const std::filesystem::path& tiny_model_file();

/// The tiny model in C hands; released at the end.
struct Model {
  lte_model* handle = nullptr;
  Model();
  ~Model() { lte_model_release(handle); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
};

struct Embedding {
  lte_embedding* handle = nullptr;
  Embedding(const lte_model* model, const lte_scene_points& points);
  ~Embedding() { lte_embedding_release(handle); }
  Embedding(const Embedding&) = delete;
  Embedding& operator=(const Embedding&) = delete;
};

/// [N, 3] float32, contiguous, without gaps.
lte_float3_view view(const at::Tensor& triples);

/// Borrows the tensors of `points`, area included.
lte_scene_points c_points(const nn::PointSet& points, bool light = false);
lte_queries c_queries(const nn::QuerySet& queries);

/// The answers of lte_embedding_decode(), [N, 3]; it must succeed.
at::Tensor decode(const lte_embedding* embedding, const lte_queries& queries);

}  // namespace lte::test
