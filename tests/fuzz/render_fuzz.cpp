// The render path: a scene from bytes, of whatever format they look like, is sampled, encoded and
// decoded by a small network of random weights, and traced from a camera. The network comes as the
// C library of an ordinary build, so LibTorch needs no headers that clang takes.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

#include "lte/c_api.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/sampler.h"
#include "tests/fuzz/load.h"

namespace lte::fuzz {
namespace {

constexpr int64_t kScenePoints = 64;
constexpr int kWidth = 4, kHeight = 3;

[[noreturn]] void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

void check(lte_status status, const char* what) {
  if (status != LTE_OK) finding(concat(what, ": ", lte_last_error()));
}

void check_finite(std::span<const Vec3> values, const char* what) {
  for (size_t i = 0; i < values.size(); ++i)
    if (!is_finite(values[i])) finding(concat(what, " ", i, " is not finite"));
}

const lte_model* network() {
  static lte_model* const model = [] {
    lte_model* opened = nullptr;
    check(lte_set_threads(1), "threads");
    check(lte_model_open(LTE_FUZZ_MODEL, nullptr, &opened), "model");
    return opened;
  }();
  return model;
}

lte_float3_view view(const std::vector<Vec3>& values) { return {&values[0].x, 0}; }

std::vector<Vec3> predict(const scene::SurfaceSamples& points, const pathtrace::GBuffer& hits) {
  lte_scene_points scene = {};
  scene.struct_size = sizeof scene;
  scene.count = points.size();
  scene.position = view(points.position);
  scene.normal = view(points.normal);
  scene.albedo = view(points.albedo);
  scene.emission = view(points.emission);
  scene.area = points.area.data();
  scene.rescale = 1;
  lte_embedding* embedding = nullptr;
  check(lte_model_encode(network(), &scene, &embedding), "encode");
  lte_queries queries = {};
  queries.struct_size = sizeof queries;
  queries.count = static_cast<int64_t>(hits.position.size());
  queries.position = view(hits.position);
  queries.normal = view(hits.normal);
  queries.albedo = view(hits.albedo);
  queries.mask = hits.mask.data();
  std::vector<Vec3> irradiance(hits.position.size());
  check(lte_embedding_decode(embedding, &queries, &irradiance[0].x, 0), "decode");
  lte_embedding_release(embedding);
  return irradiance;
}

/// What an lte::Error says of such a scene: that there is nothing to draw points from.
scene::SurfaceSamples sample(const pathtrace::Bvh& bvh, bool prune) {
  scene::SamplerOptions sampler;
  sampler.emissive_share = 0.2;
  if (!prune) return scene::sample_surface(bvh.scene(), kScenePoints, sampler);
  pathtrace::PruneCounts counts;
  return pathtrace::sample_reached_surface(bvh, kScenePoints, sampler, pathtrace::Purpose::Scene,
                                           {}, &counts);
}

void render(const scene::Scene& scene, bool prune) {
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const scene::SurfaceSamples points = sample(bvh, prune);
  check_finite(points.position, "scene point");
  check_finite(points.emission, "emission of scene point");
  const scene::Camera camera =
      scene.cameras.empty() ? pathtrace::auto_camera(bvh) : scene.cameras.front();
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, kWidth, kHeight);
  check_finite(predict(points, hits), "predicted irradiance");

  std::vector<Vec3> position, normal;
  for (size_t i = 0; i < hits.position.size(); ++i) {
    if (hits.mask[i] == 0) continue;
    position.push_back(hits.position[i]);
    normal.push_back(hits.normal[i]);
  }
  pathtrace::IrradianceOptions options;
  options.rays = 2;
  if (!lights.empty()) {
    const auto light = pathtrace::estimate_irradiance(bvh, lights, position, normal, options);
    check_finite(light.direct, "direct irradiance");
    check_finite(light.indirect, "indirect irradiance");
  }
  pathtrace::RenderOptions paths;
  paths.spp = 1;
  for (const float value :
       pathtrace::render_reference(bvh, lights, camera, kWidth, kHeight, paths).pixels) {
    if (!std::isfinite(value)) finding("a pixel of the reference is not finite");
  }
}

const char* file_name(std::string_view bytes) {
  if (bytes.starts_with("glTF") || bytes.starts_with('{')) return "scene.glb";
  if (bytes.starts_with("ply") || bytes.starts_with("\x1f\x8b")) return "scene.ply";
  return bytes.starts_with('v') || bytes.starts_with("mtllib") ? "scene.obj" : "scene.pbrt";
}

}  // namespace
}  // namespace lte::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lte;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const char* name = fuzz::file_name(bytes);
  fuzz::write(name, bytes);
  scene::LoadLimits limits = fuzz::small_limits();
  limits.triangles = 2'000;
  const std::optional<scene::Scene> scene = fuzz::load(name, limits);
  if (!scene) return 0;
  try {
    fuzz::render(*scene, size % 2 == 0);
  } catch (const Error& error) {
    const std::string_view what = error.what();
    if (what.find('\n') != what.npos) fuzz::finding(error.what());
  }
  return 0;
}
