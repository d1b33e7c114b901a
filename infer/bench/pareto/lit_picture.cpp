#include "infer/bench/pareto/lit_picture.h"

#include <numeric>
#include <utility>

#include "infer/picture/compose.h"
#include "infer/picture/picture_band.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {
namespace {

constexpr int kMetalPaths = 64;  // a pixel, as lte_render has them

std::vector<Rgb> direct_light(const MethodScene& scene, const QueryPoints& queries, int samples) {
  std::vector<uint64_t> streams(queries.position.size());
  std::iota(streams.begin(), streams.end(), uint64_t{0});
  pathtrace::DirectOptions options;
  options.seed = scene.seed;
  return pathtrace::estimate_direct(scene.renderer.bvh(), scene.renderer.lights(),
                                    {queries.position, queries.normal, streams},
                                    std::vector<int32_t>(streams.size(), samples), options)
      .irradiance;
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
                              const PointIrradiance& light, StageTimes* stages) {
  Timer timer;
  const auto lap = [&](const char* stage) {
    (*stages)[stage] += timer.seconds();
    timer.restart();
  };
  const PictureBand band(scene.renderer.bvh(), camera, {scene.width, scene.height, 0, scene.height},
                         {kAntialias, Metal::Trace, false});
  lap("primary");
  const QuerySet& queries = band.queries();
  BandLight found;
  DirectAndIndirect answers = light({queries.position, queries.normal, queries.albedo});
  found.direct = std::move(answers.direct);
  found.indirect = std::move(answers.indirect);
  timer.restart();
  if (!band.traced_pixels().empty()) {
    found.traced = pathtrace::trace_pixels(scene.renderer.bvh(), scene.renderer.lights(), camera,
                                           scene.width, scene.height, band.traced_pixels(),
                                           {kMetalPaths, scene.max_depth + 1, scene.seed});
    lap("metal");
  }
  Frame frame = band.resolve(found);
  frame.color = compose(frame, Output::Full);
  return picture_of(frame);
}

MethodPicture compose_picture(const MethodScene& scene, const scene::Camera& camera,
                              int direct_samples, const IndirectLight& indirect,
                              StageTimes* stages) {
  const auto both = [&](const QueryPoints& queries) {
    DirectAndIndirect out;
    Timer timer;
    out.indirect = indirect(queries);
    (*stages)["indirect"] += timer.seconds();
    timer.restart();
    out.direct = direct_light(scene, queries, direct_samples);
    (*stages)[kDirect] += timer.seconds();
    return out;
  };
  return compose_picture(scene, camera, both, stages);
}

}  // namespace lte::infer
