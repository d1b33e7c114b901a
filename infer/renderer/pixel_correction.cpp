#include "infer/renderer/pixel_correction.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "infer/picture/antialias.h"
#include "infer/picture/picture_band.h"
#include "infer/renderer/render_settings.h"
#include "infer/renderer/residual_bands.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

using image::Image;
using pathtrace::RadianceLayers;

/// Channels that reflect less have no irradiance to speak of.
constexpr float kLeastAlbedo = 1e-3f;
/// Paths in both halves that tell more of a lamp's share in a pixel than the hits at its edge, of
/// which there are up to as many in strata.
constexpr int32_t kEmissionPaths = lamp_hits(kAntialias);
/// Of the picture's mean: what is darker counts like that in statistics of radiance.
constexpr float kDark = 0.1f;

/// One of the picture's parts: what it shows and what paths found.
struct Part {
  Image* layer;  ///< irradiance
  std::array<const Image*, 2> radiance;
};

/// Pixels that have paths and are of one of these kinds.
std::vector<uint8_t> pixels_of(std::span<const PixelKind> kinds, std::span<const int32_t> paths,
                               std::initializer_list<PixelKind> wanted) {
  std::vector<uint8_t> out(kinds.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = paths[i] > 0 && std::ranges::find(wanted, kinds[i]) != wanted.end();
  return out;
}

bool any(const std::vector<uint8_t>& mask) {
  return std::ranges::any_of(mask, [](uint8_t is) { return is != 0; });
}

/// Irradiance, smoothed over the surface.
void correct_smooth(const SurfaceGuides& guides, std::span<const uint8_t> mask,
                    std::span<const Part> parts, const Image& albedo) {
  std::vector<ResidualHalves> residuals;
  for (const Part& part : parts) {
    const Image black(albedo.width, albedo.height, 3);
    ResidualHalves& halves = residuals.emplace_back(ResidualHalves{black, black});
    for (size_t k = 0; k < black.pixels.size(); ++k) {
      const float reflects = albedo.pixels[k];
      if (!mask[k / 3] || reflects < kLeastAlbedo) continue;
      halves.a.pixels[k] = part.radiance[0]->pixels[k] * kPi / reflects - part.layer->pixels[k];
      halves.b.pixels[k] = part.radiance[1]->pixels[k] * kPi / reflects - part.layer->pixels[k];
    }
  }
  const std::vector<Image> errors =
      error_of(std::move(residuals), {guides.normal, guides.position, mask});
  for (size_t p = 0; p < parts.size(); ++p) {
    std::vector<float>& values = parts[p].layer->pixels;
    for (size_t k = 0; k < values.size(); ++k) {
      if (mask[k / 3]) values[k] = std::max(0.0f, values[k] + errors[p].pixels[k]);
    }
  }
}

/// Radiance of pixels that stand alone.
Image corrected_radiance(const Image& radiance, const std::array<const Image*, 2>& found,
                         std::span<const uint8_t> mask, std::span<const float> scale) {
  ResidualHalves residual{*found[0], *found[1]};
  for (size_t k = 0; k < radiance.pixels.size(); ++k) {
    residual.a.pixels[k] -= radiance.pixels[k];
    residual.b.pixels[k] -= radiance.pixels[k];
  }
  Image out = error_of_pixels(residual, mask, scale);
  for (size_t k = 0; k < out.pixels.size(); ++k)
    out.pixels[k] = std::max(0.0f, out.pixels[k] + radiance.pixels[k]);
  return out;
}

Image reflected(const Image& albedo, const Image& irradiance) {
  Image out = albedo;
  for (size_t k = 0; k < out.pixels.size(); ++k) out.pixels[k] *= irradiance.pixels[k] / kPi;
  return out;
}

}  // namespace

std::vector<PixelKind> pixel_kinds(const pathtrace::GBuffer& hits, float pixel_size,
                                   bool keep_metal) {
  const PictureRows rows{hits.width, hits.height, 0, hits.height};
  std::vector<PixelKind> out(hits.mask.size(), PixelKind::Smooth);
  for (const int32_t pixel : find_edges({hits, rows, pixel_size}))
    out[static_cast<size_t>(pixel)] = PixelKind::Rough;
  for (size_t i = 0; i < out.size(); ++i) {
    const bool metal = !hits.metallic.empty() && is_metal(hits.metallic[i]);
    if (metal || !hits.mask[i] || max_component(hits.albedo[i]) < kLeastAlbedo)
      out[i] = PixelKind::Rough;
    if (metal && keep_metal) out[i] = PixelKind::Fixed;
  }
  return out;
}

std::vector<float> relative_scale(const Frame& frame) {
  const size_t pixels = frame.albedo.pixels.size() / 3;
  std::vector<float> shown(pixels);
  double sum = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const Rgb light = frame.direct.rgb(i) + frame.indirect.rgb(i);
    shown[i] = luminance(frame.emission.rgb(i) + frame.albedo.rgb(i) * light * (1 / kPi));
    sum += double{shown[i]};
  }
  const float dark = kDark * static_cast<float>(sum / static_cast<double>(pixels)) + 1e-30f;
  for (float& value : shown) value = 1 / (value + dark);
  return shown;
}

void correct_pixels(const SurfaceGuides& guides, std::span<const PixelKind> kinds,
                    std::span<const int32_t> paths, const std::array<RadianceLayers, 2>& halves,
                    Frame* frame) {
  LTE_CHECK(guides.pixels() == kinds.size() && kinds.size() == paths.size() &&
                frame->albedo.pixels.size() == 3 * kinds.size() && frame->direct.width > 0 &&
                frame->indirect.width > 0,
            "correction by paths: pictures of different sizes");
  const std::vector<float> scale = relative_scale(*frame);
  const std::array<Part, 2> parts{
      Part{&frame->direct, {&halves[0].direct, &halves[1].direct}},
      Part{&frame->indirect, {&halves[0].indirect, &halves[1].indirect}}};
  const std::vector<uint8_t> smooth = pixels_of(kinds, paths, {PixelKind::Smooth});
  const std::vector<uint8_t> rough = pixels_of(kinds, paths, {PixelKind::Rough});
  std::array<Image, 2> alone;
  for (size_t p = 0; p < parts.size(); ++p) {
    alone[p] = corrected_radiance(reflected(frame->albedo, *parts[p].layer), parts[p].radiance,
                                  rough, scale);
  }
  if (any(smooth)) correct_smooth(guides, smooth, parts, frame->albedo);
  // Few paths can find lamps that no hit has met, but not say better where a lamp ends.
  std::vector<uint8_t> emission = pixels_of(kinds, paths, {PixelKind::Smooth, PixelKind::Rough});
  for (size_t i = 0; i < emission.size(); ++i) {
    if (2 * paths[i] < kEmissionPaths && max_component(frame->emission.rgb(i)) > 0) emission[i] = 0;
  }
  frame->emission = corrected_radiance(frame->emission, {&halves[0].emission, &halves[1].emission},
                                       emission, scale);
  for (size_t k = 0; k < frame->albedo.pixels.size(); ++k) {
    if (!rough[k / 3]) continue;
    float& albedo = frame->albedo.pixels[k];
    if (alone[0].pixels[k] + alone[1].pixels[k] > 0) albedo = std::max(albedo, kLeastTracedAlbedo);
    for (size_t p = 0; p < parts.size(); ++p) {
      parts[p].layer->pixels[k] =
          albedo > 0 ? alone[p].pixels[k] * kPi / albedo : parts[p].layer->pixels[k];
    }
  }
}

}  // namespace lte::infer
