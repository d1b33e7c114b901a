#include "infer/picture/compose.h"

#include <algorithm>
#include <utility>

#include "infer/picture/picture_band.h"
#include "lte/base/parallel.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int64_t kValues = 1 << 16;  // that a thread takes at a time

/// Adds albedo / π · irradiance: the radiance a Lambertian surface sends back.
void add_reflected(Image* sum, const Image& albedo, const Image& irradiance) {
  if (irradiance.width == 0) return;
  parallel_for(static_cast<int64_t>(sum->pixels.size()), kValues, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      sum->pixels[i] += albedo.pixels[i] * irradiance.pixels[i] / kPi;
  });
}

/// Copies the rows of a band, which begin at row `first`, into a picture of `height` rows that is
/// made where it is missing.
void put_rows(const Image& band, int first, int height, Image* picture) {
  if (band.width == 0) return;
  if (band.height == height) {
    *picture = band;
    return;
  }
  if (picture->width == 0) *picture = Image(band.width, height, band.channels);
  std::copy(band.pixels.begin(), band.pixels.end(),
            picture->pixels.begin() + static_cast<int64_t>(picture->offset(0, first)));
}

}  // namespace

Image compose(const Frame& frame, Output output) {
  switch (output) {
    case Output::Albedo:
    case Output::Attention:  // until it is painted
      return frame.albedo;
    case Output::Normal:
      return frame.normal;
    case Output::Depth:
      return frame.depth;
    case Output::Irradiance:
      return frame.indirect;
    default:
      break;
  }
  Image out(frame.albedo.width, frame.albedo.height, 3);
  if (output == Output::Full) out = frame.emission;
  if (output != Output::Gi) add_reflected(&out, frame.albedo, frame.direct);
  if (output == Output::Direct) return out;
  add_reflected(&out, frame.albedo, frame.indirect);
  add_reflected(&out, frame.albedo, frame.total);
  return out;
}

void put_radiance(pathtrace::RadianceLayers layers, Frame* frame) {
  frame->emission = std::move(layers.emission);
  frame->direct = std::move(layers.direct);
  frame->indirect = std::move(layers.indirect);
  for (size_t i = 0; i < frame->albedo.pixels.size(); ++i) {
    float &direct = frame->direct.pixels[i], &indirect = frame->indirect.pixels[i];
    if (!(direct + indirect > 0)) continue;
    float& albedo = frame->albedo.pixels[i];
    albedo = std::max(albedo, kLeastTracedAlbedo);
    direct *= kPi / albedo;
    indirect *= kPi / albedo;
  }
}

void put_band(const Frame& band, int first, bool layers, int height, Frame* frame) {
  put_rows(band.color, first, height, &frame->color);
  put_rows(band.depth, first, height, &frame->depth);
  if (layers) {
    put_rows(band.albedo, first, height, &frame->albedo);
    put_rows(band.normal, first, height, &frame->normal);
    put_rows(band.mean_normal, first, height, &frame->mean_normal);
    put_rows(band.emission, first, height, &frame->emission);
    put_rows(band.direct, first, height, &frame->direct);
    put_rows(band.indirect, first, height, &frame->indirect);
    put_rows(band.total, first, height, &frame->total);
  }
  frame->background += band.background;
  frame->queries += band.queries;
  frame->decoded += band.decoded;
  frame->edge_pixels += band.edge_pixels;
  frame->correction_paths += band.correction_paths;
  frame->traced_pixels += band.traced_pixels;
  frame->metal += band.metal;
  frame->metal_by_default += band.metal_by_default;
}

}  // namespace lte::infer
