// One pass of a film: camera rays of every pixel, and light at what the first of them meets.
#pragma once

#include "lte/render/progressive.h"

namespace lte::render {

/// Jittered camera rays of all pixels into the film's surfaces, and an integrator's light at the
/// first hit of each. In pixels with metal, paths through the pixel stand for that.
/// @param integrator  null: no light
/// @return            false if `stop` has ended it, between two strips of rows
bool camera_pass(const TracedScene& scene, const Integrator* integrator,
                 const scene::Camera& camera, const RenderSettings& settings,
                 const std::function<bool()>& stop, Film* film, RenderSeconds* seconds);

/// Paths through all pixels.
bool path_pass(const TracedScene& scene, const scene::Camera& camera,
               const RenderSettings& settings, const std::function<bool()>& stop, Film* film,
               RenderSeconds* seconds);

}  // namespace lte::render
