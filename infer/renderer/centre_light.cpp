#include "infer/renderer/centre_light.h"

#include <algorithm>
#include <span>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

using image::Image;

/// Estimates by paths keep two colors a point and light group: blocks bound that memory.
constexpr size_t kEstimates = size_t{1} << 21;
constexpr size_t kMostPoints = size_t{1} << 14, kLeastPoints = 1024;

/// Whether direct light is sampled where indirect light is gathered.
bool samples_sparsely(const CentreRequest& request) {
  return request.table != nullptr && request.direct && request.gather.direct;
}

/// Direct and indirect light by paths. Pixels are numbered in the order of their points, as those
/// of a picture in one band are without denoising.
void trace_paths(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                 const SurfaceGuides& guides, const CentreRequest& request, CentreLight* out) {
  pathtrace::IrradianceOptions options;
  options.rays = request.path_count;
  options.max_depth = request.indirect ? request.max_depth : 1;
  options.direct_only = !request.indirect;
  options.seed = request.shadow_rays.seed;
  const SurfacePoints points = points_of(guides);
  out->direct = Image(guides.width(), guides.height(), 3);
  if (request.indirect) out->indirect = out->direct;
  const auto groups = static_cast<size_t>(std::max(1, lights.groups()));
  const size_t block = std::min(kMostPoints, std::max(kLeastPoints, kEstimates / groups));
  for (size_t begin = 0; begin < points.pixel.size(); begin += block) {
    const size_t count = std::min(block, points.pixel.size() - begin);
    const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
        bvh, lights, std::span(points.position).subspan(begin, count),
        std::span(points.normal).subspan(begin, count), options, static_cast<int64_t>(begin));
    for (size_t i = 0; i < count; ++i) {
      const uint64_t pixel = points.pixel[begin + i];
      out->direct.set_rgb(pixel, part.direct_sum(static_cast<int64_t>(i)));
      if (request.indirect)
        out->indirect.set_rgb(pixel, part.indirect_sum(static_cast<int64_t>(i)));
    }
    if (request.done) request.done(static_cast<int64_t>(count));
  }
  const auto background = static_cast<int64_t>(guides.pixels() - points.pixel.size());
  if (request.done && background > 0) request.done(background);
}

void gather(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
            const pathtrace::GBuffer& hits, const CentreRequest& request, CentreLight* out) {
  const GatherScene scene{bvh, lights, *request.table, request.max_depth, request.shadow_rays.seed};
  const GatherDirect direct{samples_sparsely(request) ? request.shadow_rays.samples : 0,
                            request.sum};
  const GatherRows rows{hits,         request.pixel_size, request.skip_metal,
                        request.kept, request.projection, request.first_row};
  GatheredCentres light = gather_centres(scene, rows, request.gather, direct,
                                         request.correction_paths, request.gather_denoiser);
  out->indirect = std::move(light.indirect);
  out->total = std::move(light.total);
  if (direct.shadow_rays > 0) out->direct = std::move(light.direct);
  out->gathered = light.work.points;
  out->gathering_seconds = light.work.gather_seconds + light.fill_seconds;
  out->sampling_seconds += light.work.direct_seconds;
  out->path_seconds = light.path_seconds;
  out->denoising_seconds += light.denoise_seconds;
}

}  // namespace

CentreLight light_centres(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const pathtrace::GBuffer& hits, const CentreRequest& request) {
  CentreLight out;
  Image variance;
  SurfaceGuides guides;  // a draft needs none: they take as much memory as the hits
  const bool sampled = request.paths || (request.direct && !samples_sparsely(request));
  if (sampled) guides = guides_of(hits);
  Timer timer;
  if (request.paths) {
    trace_paths(bvh, lights, guides, request, &out);
  } else if (sampled) {
    ShadowRays rays = request.shadow_rays;
    rays.variance = request.denoiser != nullptr && !request.denoiser->is_oidn();
    PixelLight light = light_pixels(bvh, lights, guides, rays, request.gather.check);
    out.direct = std::move(light.irradiance);
    variance = std::move(light.variance);
  }
  out.sampling_seconds = timer.seconds();
  timer.restart();
  if (request.denoiser != nullptr && sampled) {
    image::NoisyPicture picture{&out.direct, &guides.normal, &guides.position, nullptr,
                                variance.width > 0 ? &variance : nullptr};
    if (out.direct.width > 0) out.direct = request.denoiser->denoise(picture, request.quality);
    if (out.indirect.width > 0) {
      picture.light = &out.indirect;
      picture.variance = nullptr;
      out.indirect = request.denoiser->denoise(picture);
    }
    out.denoising_seconds = timer.seconds();
  }
  if (request.paths) return out;
  if (request.table != nullptr) gather(bvh, lights, hits, request, &out);
  if (request.done) request.done(static_cast<int64_t>(hits.mask.size()));
  return out;
}

}  // namespace lte::infer
