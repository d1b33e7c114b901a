// What a picture is asked for, what a scene is encoded with, and the stages that are timed.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>

#include "lte/embed/embed.h"
#include "lte/image/oidn.h"
#include "lte/render/frame.h"
#include "lte/render/integrator.h"

namespace lte::infer {

using embed::EmbedSettings;
using render::Frame;
using render::Method;
using render::Output;

struct RenderSettings {
  Output output = Output::Full;
  Method method = Method::Gather;
  int width = 512, height = 512;
  /// Passes (render::Until), by whichever ends first. Of Method::Path a pass has path_samples
  /// paths a pixel.
  int passes = 16;
  double seconds = std::numeric_limits<double>::infinity();  ///< denoising included
  bool denoise = true;
  bool layers = true;  ///< render::PictureSettings::layers
  image::OidnQuality denoise_quality = image::OidnQuality::High;
  /// render::RenderSettings has these.
  int gather_rays = 2, light_samples = 2, edge_rays = 16, path_samples = 4;
  int64_t max_samples = std::numeric_limits<int>::max();
  bool correct = true;
  int max_depth = 5;
  uint64_t seed = 0;
  /// Called now and then by the thread that renders; true ends the picture. May be null.
  std::function<bool()> stop;
  /// Told of the share of the work that is done. May be null.
  std::function<void(double share)> progress;
};

/// A picture that RenderSettings::stop has ended.
struct PictureStopped {};

/// Wall-clock seconds by stage; `load` and `write` belong to the caller. `light` is the time of the
/// estimates on scene points, for models that read them; `cache` that of the irradiance cache.
struct StageSeconds {
  double load = 0, sample = 0, light = 0, encode = 0, cache = 0, hits = 0, irradiance = 0,
         paths = 0, denoise = 0, check = 0, write = 0;
};

/// The stages in the order in which they run.
struct Stage {
  const char* name;
  double StageSeconds::*seconds;
};
inline constexpr std::array<Stage, 11> kStages = {{{"load", &StageSeconds::load},
                                                   {"sample", &StageSeconds::sample},
                                                   {"light", &StageSeconds::light},
                                                   {"encode", &StageSeconds::encode},
                                                   {"cache", &StageSeconds::cache},
                                                   {"hits", &StageSeconds::hits},
                                                   {"irradiance", &StageSeconds::irradiance},
                                                   {"paths", &StageSeconds::paths},
                                                   {"denoise", &StageSeconds::denoise},
                                                   {"check", &StageSeconds::check},
                                                   {"write", &StageSeconds::write}}};
/// Those of Renderer::render(), and the check's.
inline constexpr std::array<double StageSeconds::*, 5> kPictureStages = {
    &StageSeconds::hits, &StageSeconds::irradiance, &StageSeconds::paths, &StageSeconds::denoise,
    &StageSeconds::check};

}  // namespace lte::infer
