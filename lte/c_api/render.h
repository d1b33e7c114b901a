// Scene files of a C program: loaded, encoded, lit and rendered by lte/render.
#pragma once

#include <memory>
#include <utility>

#include "lte/c_render.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/render/integrator.h"
#include "lte/render/shared_denoiser.h"
#include "lte/scene/scene.h"

namespace lte::c_api {

/// A scene with what its integrators share.
struct TracedFile {
  explicit TracedFile(scene::Scene loaded) : scene(std::move(loaded)) {}

  const scene::Scene scene;
  const pathtrace::Bvh bvh{scene};
  const pathtrace::Lights lights{scene};
  mutable render::SharedDenoiser denoiser;  ///< thread-safe
};

}  // namespace lte::c_api

struct lte_scene {
  std::shared_ptr<const lte::c_api::TracedFile> file;
};

struct lte_integrator {
  std::shared_ptr<const lte::c_api::TracedFile> file;
  std::unique_ptr<const lte::render::Integrator> integrator;
  int max_depth;
};

namespace lte::c_api {

/// Points have at most so many rays, and records so many paths.
inline constexpr int32_t kMaxSamples = 1 << 16;

/// All throw ApiError and lte::Error.
lte_scene* open_scene(const char* path, const lte_scene_options* options);
lte_scene_info info_of(const TracedFile& file);
lte_camera camera_of(const TracedFile& file, int64_t number);
lte_embedding* encode_scene(const TracedFile& file, const lte_model& model,
                            const lte_scene_encode_options& options);
lte_integrator* make_integrator(const lte_scene& scene, const lte_integrator_options& options);

/// Where irradiance goes, [count, 3] floats; null: not wanted.
struct IrradianceOut {
  float *direct, *indirect;
  int64_t stride;
};
void irradiance(const render::Integrator& integrator, const lte_queries& points,
                render::PointSampling sampling, const IrradianceOut& out);

void render_picture(const lte_integrator& by, const lte_camera& camera,
                    const lte_render_options& options, const lte_picture& picture);

}  // namespace lte::c_api
