#include "tests/c_api/support.h"

#include <cstdlib>

#include <ATen/ATen.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/nn/model_file.h"
#include "tests/nn/support.h"

namespace lte::test {
namespace {

namespace fs = std::filesystem;

fs::path save_tiny_model() {
  const fs::path path =
      fs::temp_directory_path() / ("lte_c_api_" + std::to_string(::getpid()) + ".safetensors");
  nn::LightTransportModel model(tiny_config());
  randomize(*model, 5);
  nn::save_model(path, model,
                 {{"scene_points", "300"}, {"scene_points_pruned", "true"}, {"suns", "true"}});
  std::atexit([] { fs::remove(tiny_model_file()); });
  return path;
}

}  // namespace

const fs::path& tiny_model_file() {
  static const auto* const path = new fs::path(save_tiny_model());  // outlives atexit()
  return *path;
}

Model::Model() {
  EXPECT_EQ(lte_model_open(tiny_model_file().c_str(), nullptr, &handle), LTE_OK)
      << lte_last_error();
}

Embedding::Embedding(const lte_model* model, const lte_scene_points& points) {
  EXPECT_EQ(lte_model_encode(model, &points, &handle), LTE_OK) << lte_last_error();
}

lte_float3_view view(const at::Tensor& triples) { return {triples.const_data_ptr<float>(), 0}; }

lte_scene_points c_points(const nn::PointSet& points, bool light) {
  lte_scene_points out = {};
  out.struct_size = sizeof out;
  out.count = points.position.size(0);
  out.position = view(points.position);
  out.normal = view(points.normal);
  out.albedo = view(points.albedo);
  out.emission = view(points.emission);
  out.area = points.area.const_data_ptr<float>();
  if (light) {
    out.direct = view(points.direct);
    out.indirect = view(points.indirect);
    out.direct_back = view(points.direct_back);
    out.indirect_back = view(points.indirect_back);
    out.indirect_error = points.indirect_error.const_data_ptr<float>();
  }
  return out;
}

lte_queries c_queries(const nn::QuerySet& queries) {
  lte_queries out = {};
  out.struct_size = sizeof out;
  out.count = queries.position.size(0);
  out.position = view(queries.position);
  out.normal = view(queries.normal);
  out.albedo = view(queries.albedo);
  return out;
}

at::Tensor decode(const lte_embedding* embedding, const lte_queries& queries) {
  at::Tensor out = at::full({queries.count, 3}, -1.0f);
  EXPECT_EQ(lte_embedding_decode(embedding, &queries, out.data_ptr<float>(), 0), LTE_OK)
      << lte_last_error();
  return out;
}

}  // namespace lte::test
