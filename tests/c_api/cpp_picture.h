// What the C++ library makes of a scene, for pictures of lte/c_render.h to be held against.
#pragma once

#include <string>

#include "lte/c_render.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/scene/load.h"

namespace lte::test {

/// The picture of the file's first camera by so many passes; an irradiance cache has 512 records.
inline render::Frame cpp_picture(const std::string& file, lte_method method, int width, int height,
                                 int passes) {
  const scene::Scene scene = scene::load_scene(file);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  render::CacheSettings cache;
  cache.records = 512;
  const auto integrator = method == LTE_METHOD_PATH ? render::make_path({bvh, lights}, 5)
                                                    : render::make_gather({bvh, lights}, cache);
  integrator->prepare();
  render::RenderSettings settings;
  if (method == LTE_METHOD_PATH) settings.path_samples = 4;
  render::Film film(width, height);
  render::Until until;
  until.passes = passes;
  render::render({bvh, lights}, *integrator, scene.cameras[0], settings, until, &film);
  const image::Denoiser denoiser;
  return render::make_picture(film, {.denoiser = &denoiser, .quality = image::OidnQuality::Fast});
}

}  // namespace lte::test
