// The functions of lte/c_render.h: null checks, structs in and out, and nothing past the boundary.
#include "lte/c_api/arguments.h"
#include "lte/c_api/error.h"
#include "lte/c_api/handles.h"
#include "lte/c_api/render.h"
#include "lte/c_render.h"

using lte::c_api::apply_threads;
using lte::c_api::guarded;
using lte::c_api::read_struct;
using lte::c_api::require;
using lte::c_api::write_struct;

namespace {

/// Zeros where there are no options.
template <typename T>
T read_options(const T* options, const char* name) {
  return options == nullptr ? T{} : read_struct(options, name);
}

}  // namespace

lte_status lte_scene_open(const char* path, const lte_scene_options* options, lte_scene** scene) {
  if (scene != nullptr) *scene = nullptr;
  return guarded(
      [&] {
        require(scene != nullptr, "scene is null");
        require(path != nullptr, "path is null");
        *scene = lte::c_api::open_scene(path, options);
      },
      LTE_ERROR_FILE);
}

lte_status lte_scene_get_info(const lte_scene* scene, lte_scene_info* info) {
  return guarded([&] {
    require(scene != nullptr, "scene is null");
    write_struct(lte::c_api::info_of(*scene->file), info, "lte_scene_info");
  });
}

lte_status lte_scene_get_camera(const lte_scene* scene, int64_t number, lte_camera* camera) {
  return guarded([&] {
    require(scene != nullptr, "scene is null");
    write_struct(lte::c_api::camera_of(*scene->file, number), camera, "lte_camera");
  });
}

lte_status lte_scene_encode(const lte_scene* scene, const lte_model* model,
                            const lte_scene_encode_options* options, lte_embedding** embedding) {
  if (embedding != nullptr) *embedding = nullptr;
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    require(scene != nullptr, "scene is null");
    require(model != nullptr, "model is null");
    const lte_scene_encode_options how = read_options(options, "lte_scene_encode_options");
    apply_threads();
    *embedding = lte::c_api::encode_scene(*scene->file, *model, how);
  });
}

void lte_scene_release(lte_scene* scene) { delete scene; }

lte_status lte_integrator_create(const lte_scene* scene, const lte_integrator_options* options,
                                 lte_integrator** integrator) {
  if (integrator != nullptr) *integrator = nullptr;
  return guarded([&] {
    require(integrator != nullptr, "integrator is null");
    require(scene != nullptr, "scene is null");
    const lte_integrator_options how = read_options(options, "lte_integrator_options");
    apply_threads();
    *integrator = lte::c_api::make_integrator(*scene, how);
  });
}

lte_status lte_integrator_irradiance(const lte_integrator* integrator, const lte_queries* points,
                                     int32_t samples, uint64_t seed, float* direct, float* indirect,
                                     int64_t stride) {
  return guarded([&] {
    require(integrator != nullptr, "integrator is null");
    const lte_queries at = read_struct(points, "lte_queries");
    require(samples >= 1 && samples <= lte::c_api::kMaxSamples, "samples is ", samples,
            ", expected 1 to ", lte::c_api::kMaxSamples);
    apply_threads();
    lte::c_api::irradiance(*integrator->integrator, at,
                           {.rays = samples, .light_samples = samples, .seed = seed},
                           {direct, indirect, stride});
  });
}

void lte_integrator_release(lte_integrator* integrator) { delete integrator; }

lte_status lte_render(const lte_integrator* integrator, const lte_camera* camera,
                      const lte_render_options* options, const lte_picture* picture) {
  return guarded([&] {
    require(integrator != nullptr, "integrator is null");
    const lte_camera from = read_struct(camera, "lte_camera");
    const lte_render_options how = read_options(options, "lte_render_options");
    const lte_picture to = read_struct(picture, "lte_picture");
    apply_threads();
    lte::c_api::render_picture(*integrator, from, how, to);
  });
}
