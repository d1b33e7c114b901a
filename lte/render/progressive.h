// The progressive renderer: a film gets pass after pass, each of some samples a pixel, until there
// are enough of them, time is over, the error is low enough, or somebody says stop. A picture can
// be made of the film at any time (combine.h).
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "lte/render/film.h"
#include "lte/render/integrator.h"
#include "lte/scene/scene.h"

namespace lte::render {

/// What a film is for, and what a pass is.
struct RenderSettings {
  bool direct = true, indirect = true;  ///< light that is wanted; neither: surfaces alone
  /// The film's light is irradiance and not radiance: that of a surface whose albedo is pi, metal
  /// and black ones too. Lamps do not shine.
  bool irradiance = false;
  int rays = 2;           ///< PointSampling::rays of the hit of a pixel's camera ray, a pass
  int light_samples = 2;  ///< PointSampling::light_samples of it
  /// Camera rays of pixels at edges in the first pass (edges.h), in place of the one through the
  /// center: half as many where those meet one surface alone. 0: none.
  int edge_rays = 16;
  /// Paths through each whole pixel that a path pass has.
  int path_samples = 1;
  /// Rays, light samples and paths a pixel, each in all passes together: the last pass has what is
  /// left.
  int64_t max_samples = std::numeric_limits<int>::max();
  /// Paths beside an integrator that is not Method::Path: what it is wrong by, they correct
  /// (combine.h). From kCorrectFrom passes on, one path pass a pass.
  bool correct = true;
  int max_depth = 5;  ///< surface hits of light's path after the first one that the camera sees
  uint64_t seed = 0;
};

/// Passes by an integrator before paths stand beside it.
inline constexpr int kCorrectFrom = 8;

/// When a film is done: by whichever comes first, but for `stop` never before its first pass.
struct Until {
  int passes = std::numeric_limits<int>::max();
  /// From the call on. No pass begins that would end later, as the ones before foretell.
  double seconds = std::numeric_limits<double>::infinity();
  double error = 0;  ///< LightEstimate::relative_error() of the film's light
  /// Asked now and then, by the calling thread, also within a pass; true ends it. Pixels that the
  /// first pass has not come to then have no samples. May be null.
  std::function<bool()> stop = {};
  /// Told of the film after each pass, with the share of the work that is done. May be null.
  std::function<void(const Film&, double share)> pass_done = {};
};

/// Wall-clock seconds of what render() did, summed over calls.
struct RenderSeconds {
  double hits = 0, light = 0, paths = 0;
};

/// Adds passes to a film of this scene, camera and these settings. What it adds depends on the
/// passes that the film has, not on the number of threads.
/// @param integrator  prepared
/// @throws lte::Error if the camera is degenerate or a count is out of range.
void render(const TracedScene& scene, const Integrator& integrator, const scene::Camera& camera,
            const RenderSettings& settings, const Until& until, Film* film,
            RenderSeconds* seconds = nullptr);

}  // namespace lte::render
