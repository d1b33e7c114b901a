#include "lte/render/progressive.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/render/camera_pass.h"

namespace lte::render {
namespace {

void check(const TracedScene& scene, const RenderSettings& settings, const Film& film) {
  LTE_CHECK(&scene.bvh.scene() == &scene.lights.scene(),
            "the BVH and the lights are of two scenes");
  LTE_CHECK(film.width > 0 && film.height > 0, "a film needs a positive size");
  const auto at_least = [](const char* what, int value, int least) {
    LTE_CHECK(value >= least, what, " must be at least ", least, ", got ", value);
  };
  at_least("camera rays at an edge", settings.edge_rays, 0);
  at_least("rays a point", settings.rays, 1);
  at_least("light samples a point", settings.light_samples, 1);
  at_least("paths a pixel and pass", settings.path_samples, 1);
  at_least("max_depth", settings.max_depth, 1);
}

/// Seconds of passes of one kind: the last one's foretells the next.
struct Pace {
  double last = 0;

  template <typename Pass>
  bool time(const Pass& pass) {
    const Timer timer;
    const bool done = pass();
    last = timer.seconds();
    return done;
  }
};

}  // namespace

void render(const TracedScene& scene, const Integrator& integrator, const scene::Camera& camera,
            const RenderSettings& settings, const Until& until, Film* film,
            RenderSeconds* seconds) {
  check(scene, settings, *film);
  RenderSeconds unasked;
  if (seconds == nullptr) seconds = &unasked;
  const Timer timer;
  const bool lit = (settings.direct || settings.indirect) && !scene.lights.empty();
  // Paths through pixels know no irradiance.
  const bool by_paths = integrator.method() == Method::Path && !settings.irradiance;
  const bool corrects = lit && settings.correct && settings.indirect && !settings.irradiance &&
                        integrator.method() != Method::Path;
  const Integrator* const at_points = lit && !by_paths ? &integrator : nullptr;
  Pace points, paths;
  const int begun = film->passes;
  const auto fits = [&](double pass) { return timer.seconds() + pass <= until.seconds; };
  const auto converged = [&] {
    const LightEstimate& light = film->gathered.empty() ? film->paths : film->gathered;
    return until.error > 0 && light.relative_error() <= until.error;
  };
  while (film->passes < until.passes) {
    const bool first = film->passes == 0;
    if ((until.stop && until.stop()) || (!first && (!fits(points.last) || converged()))) return;
    if (!points.time([&] {
          return camera_pass(scene, at_points, camera, settings, until.stop, film, seconds);
        }))
      return;
    const bool beside = corrects && film->passes > kCorrectFrom;
    if (lit && (by_paths || beside)) {
      if (!first && !fits(paths.last)) return;
      if (!paths.time(
              [&] { return path_pass(scene, camera, settings, until.stop, film, seconds); }))
        return;
    }
    if (!until.pass_done) continue;
    const double time = timer.seconds() / until.seconds;
    const double counted =
        static_cast<double>(film->passes - begun) / static_cast<double>(until.passes - begun);
    until.pass_done(*film, std::min(1.0, std::max(time, counted)));
  }
}

}  // namespace lte::render
