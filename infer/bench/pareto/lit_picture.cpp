#include "infer/bench/pareto/lit_picture.h"

#include <algorithm>
#include <span>

#include "infer/picture/picture_band.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {
namespace {

// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kGroupBlock = int64_t{1} << 21;
constexpr int kMetalPaths = 64;  // a pixel, as lte_render has them

std::vector<Rgb> direct_light(const MethodScene& scene, const QuerySet& queries, int samples) {
  pathtrace::IrradianceOptions options;
  options.rays = samples;
  options.max_depth = 1;
  options.seed = scene.seed;
  options.direct_only = true;
  options.variance = false;
  const int64_t groups = std::max(1, scene.renderer.lights().groups());
  const int64_t block = std::max<int64_t>(1024, kGroupBlock / groups);
  std::vector<Rgb> out;
  out.reserve(queries.position.size());
  for (int64_t begin = 0; begin < queries.size(); begin += block) {
    const auto b = static_cast<size_t>(begin),
               n = static_cast<size_t>(std::min(block, queries.size() - begin));
    const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
        scene.renderer.bvh(), scene.renderer.lights(), std::span(queries.position).subspan(b, n),
        std::span(queries.normal).subspan(b, n), options, begin);
    for (int64_t i = 0; i < static_cast<int64_t>(n); ++i) out.push_back(part.direct_sum(i));
  }
  return out;
}

}  // namespace

MethodPicture picture_of(const Frame& frame) {
  MethodPicture out{frame.color, {}};
  if (frame.indirect.width == 0) return out;
  out.indirect = [indirect = frame.indirect, albedo = frame.albedo] {
    image::Image reflected = indirect;
    for (size_t i = 0; i < reflected.pixels.size(); ++i)
      reflected.pixels[i] *= albedo.pixels[i] / kPi;
    return reflected;
  };
  return out;
}

MethodPicture compose_picture(const MethodScene& scene, const scene::Camera& camera,
                              int direct_samples, const IndirectLight& indirect,
                              StageTimes* stages) {
  Timer timer;
  const auto lap = [&](const char* stage) {
    (*stages)[stage] += timer.seconds();
    timer.restart();
  };
  const PictureBand band(scene.renderer.bvh(), camera, {scene.width, scene.height, 0, scene.height},
                         {kAntialias, Metal::Trace, false});
  lap("primary");
  const QuerySet& queries = band.queries();
  BandLight light;
  light.indirect = indirect({queries.position, queries.normal, queries.albedo});
  lap("indirect");
  light.direct = direct_light(scene, queries, direct_samples);
  lap(kDirect);
  if (!band.traced_pixels().empty()) {
    light.traced = pathtrace::trace_pixels(scene.renderer.bvh(), scene.renderer.lights(), camera,
                                           scene.width, scene.height, band.traced_pixels(),
                                           {kMetalPaths, scene.max_depth + 1, scene.seed});
    lap("metal");
  }
  Frame frame = band.resolve(light);
  frame.color = frame.emission;
  for (size_t i = 0; i < frame.color.pixels.size(); ++i) {
    frame.color.pixels[i] +=
        frame.albedo.pixels[i] / kPi * (frame.direct.pixels[i] + frame.indirect.pixels[i]);
  }
  return picture_of(frame);
}

}  // namespace lte::infer
