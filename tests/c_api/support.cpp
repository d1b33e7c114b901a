#include "tests/c_api/support.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/base/random.h"

namespace lte::test {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kSixteenths[] = {64, 48, 80};  ///< of a metre: the sides of the box

Rgb random_color(Rng* rng, float low, float high) {
  const float r = rng->uniform(low, high), g = rng->uniform(low, high);
  return {r, g, rng->uniform(low, high)};
}

fs::path save_tiny_model() {
  const fs::path path =
      fs::temp_directory_path() / ("lte_c_api_" + std::to_string(::getpid()) + ".safetensors");
  save_random_model(path, tiny_config(),
                    {{"scene_points", "300"}, {"scene_points_pruned", "true"}, {"suns", "true"}});
  std::atexit([] { fs::remove(tiny_model_file()); });
  return path;
}

}  // namespace

BoxQueries::BoxQueries(int64_t count, uint64_t seed) {
  Rng rng(seed);
  for (int64_t i = 0; i < count; ++i) {
    Vec3 at, facing;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<float>(rng.below(kSixteenths[axis] + 1)) / 16;
    const auto wall = static_cast<int>(rng.below(3));
    const bool far = rng.below(2) == 1;
    at[wall] = far ? static_cast<float>(kSixteenths[wall]) / 16 : 0;
    facing[wall] = far ? -1 : 1;
    position.push_back(at);
    normal.push_back(facing);
    albedo.push_back(random_color(&rng, 0, 1));
  }
}

BoxScene::BoxScene(int64_t count, uint64_t seed) : BoxQueries(count, seed) {
  Rng rng(seed, 1);
  for (int64_t i = 0; i < count; ++i) {
    const bool lit = i % 10 == 0;
    const float back = i % 3 == 0 ? 0.375f : 0;  // on a sheet; the others are on closed bodies
    emission.push_back(lit ? random_color(&rng, 5, 15) : Rgb{});
    direct.push_back(lit ? Rgb{} : random_color(&rng, 0, 8));
    indirect.push_back(lit ? Rgb{} : random_color(&rng, 0, 3));
    direct_back.push_back(direct.back() * back);
    indirect_back.push_back(indirect.back() * back);
    area.push_back(rng.uniform(0.01f, 0.02f));
    for (int side = 0; side < 2; ++side)
      indirect_error.push_back(static_cast<float>((2 * i + side) % 7) / 8);
  }
}

runtime::ScenePoints BoxScene::arrays(bool light) const {
  if (!light) return {position, normal, albedo, emission, area};
  return {position, normal,      albedo,        emission,       area, direct,
          indirect, direct_back, indirect_back, indirect_error, gloss};
}

lte_float3_view view(const std::vector<Vec3>& triples) { return {&triples.data()->x, 0}; }

lte_scene_points BoxScene::in_c(bool light) const {
  lte_scene_points out = {};
  out.struct_size = sizeof out;
  out.count = static_cast<int64_t>(position.size());
  out.position = view(position);
  out.normal = view(normal);
  out.albedo = view(albedo);
  out.emission = view(emission);
  out.area = area.data();
  if (!light) return out;
  out.direct = view(direct);
  out.indirect = view(indirect);
  out.direct_back = view(direct_back);
  out.indirect_back = view(indirect_back);
  out.indirect_error = indirect_error.data();
  out.gloss = gloss.empty() ? nullptr : gloss.data();
  return out;
}

lte_queries BoxQueries::in_c() const {
  lte_queries out = {};
  out.struct_size = sizeof out;
  out.count = static_cast<int64_t>(position.size());
  out.position = view(position);
  out.normal = view(normal);
  out.albedo = view(albedo);
  return out;
}

const fs::path& tiny_model_file() {
  static const auto* const path = new fs::path(save_tiny_model());  // outlives atexit()
  return *path;
}

Model::Model(const fs::path& file) {
  EXPECT_EQ(lte_model_open(file.c_str(), nullptr, &handle), LTE_OK) << lte_last_error();
}

lte_model_info Model::info() const {
  lte_model_info info = {};
  info.struct_size = sizeof info;
  EXPECT_EQ(lte_model_get_info(handle, &info), LTE_OK) << lte_last_error();
  return info;
}

Embedding::Embedding(const lte_model* model, const lte_scene_points& points) {
  EXPECT_EQ(lte_model_encode(model, &points, &handle), LTE_OK) << lte_last_error();
}

lte_embedding_info Embedding::info() const {
  lte_embedding_info info = {};
  info.struct_size = sizeof info;
  EXPECT_EQ(lte_embedding_get_info(handle, &info), LTE_OK) << lte_last_error();
  return info;
}

Rgbs decode(const lte_embedding* embedding, const lte_queries& queries) {
  Rgbs out(static_cast<size_t>(queries.count), Rgb{-1, -1, -1});
  EXPECT_EQ(lte_embedding_decode(embedding, &queries, &out.data()->x, 0), LTE_OK)
      << lte_last_error();
  return out;
}

double relative_difference(const Rgbs& a, const Rgbs& b) {
  EXPECT_EQ(a.size(), b.size());
  double off = 0, all = 1e-60;
  for (size_t i = 0; i < b.size(); ++i) {
    off += double{dot(a[i] - b[i], a[i] - b[i])};
    all += double{dot(b[i], b[i])};
  }
  return std::sqrt(off / all);
}

Rgbs scaled(Rgbs values, const Rgb& gain) {
  for (Rgb& value : values) value *= gain;
  return values;
}

}  // namespace lte::test
