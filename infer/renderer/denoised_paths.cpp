#include "infer/renderer/denoised_paths.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "infer/picture/box_mean.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

using image::Image;
using pathtrace::RadianceLayers;

/// Half an edge of the square over which weights are estimated.
constexpr int kWindow = 16;
/// Lesser reflected light is none: there is nothing to scale.
constexpr float kBlack = 1e-12f;

/// A layer of irradiance, and the radiance that paths find of it.
struct Part {
  Image Frame::*layer;
  Image RadianceLayers::*found;
};
constexpr Part kDirect{&Frame::direct, &RadianceLayers::direct},
    kIndirect{&Frame::indirect, &RadianceLayers::indirect};

/// What the frame shows of some parts.
Image reflected_of(const Frame& frame, std::span<const Part> parts) {
  Image out(frame.albedo.width, frame.albedo.height, 3);
  for (const Part& part : parts) {
    for (size_t k = 0; k < out.pixels.size(); ++k)
      out.pixels[k] += frame.albedo.pixels[k] * (frame.*part.layer).pixels[k] / kPi;
  }
  return out;
}

/// What half of the paths found of them; where there are none, what is shown.
Image found_by(const RadianceLayers& half, std::span<const Part> parts,
               std::span<const uint8_t> drawn, const Image& shown) {
  Image out = shown;
  for (size_t k = 0; k < out.pixels.size(); ++k) {
    if (!drawn[k / 3]) continue;
    out.pixels[k] = 0;
    for (const Part& part : parts) out.pixels[k] += (half.*part.found).pixels[k];
  }
  return out;
}

/// How far to go from `shown` to `smooth[h]`, by `found[1 - h]`, per pixel.
std::vector<float> weights(const std::array<Image, 2>& found, const std::array<Image, 2>& smooth,
                           const Image& shown, std::span<const uint8_t> drawn,
                           std::span<const float> scale) {
  std::vector<float> along(drawn.size()), square(drawn.size());
  for (size_t k = 0; k < shown.pixels.size(); ++k) {
    if (!drawn[k / 3]) continue;
    const float weight = scale[k / 3] * scale[k / 3], from = shown.pixels[k];
    for (size_t h = 0; h < 2; ++h) {
      const float way = smooth[h].pixels[k] - from;
      along[k / 3] += weight * way * (found[1 - h].pixels[k] - from);
      square[k / 3] += weight * way * way;
    }
  }
  const BoxMean mean(shown.width, shown.height, drawn);
  along = mean(along, kWindow);
  square = mean(square, kWindow);
  for (size_t i = 0; i < along.size(); ++i)
    along[i] = square[i] > 0 ? std::clamp(along[i] / square[i], 0.0f, 1.0f) : 0;
  return along;
}

/// The same for pixels of either kind by themselves: at edges the denoiser errs otherwise than on
/// surfaces, and they have more paths.
std::vector<float> weights_by_kind(const std::array<Image, 2>& found,
                                   const std::array<Image, 2>& smooth, const Image& shown,
                                   std::span<const uint8_t> drawn, std::span<const PixelKind> kinds,
                                   std::span<const float> scale) {
  std::vector<float> out(drawn.size());
  for (const PixelKind kind : {PixelKind::Smooth, PixelKind::Rough}) {
    std::vector<uint8_t> some(drawn.size());
    for (size_t i = 0; i < some.size(); ++i) some[i] = drawn[i] && kinds[i] == kind;
    const std::vector<float> weight = weights(found, smooth, shown, some, scale);
    for (size_t i = 0; i < some.size(); ++i) {
      if (some[i]) out[i] = weight[i];
    }
  }
  return out;
}

/// What parts of a frame are drawn by.
struct Drawing {
  const image::Denoiser& denoiser;
  const SurfaceGuides& guides;
  std::span<const PixelKind> kinds;
  std::span<const uint8_t> drawn;
  const std::array<RadianceLayers, 2>& halves;
  const std::vector<float> scale;

  /// Draws the sum of some parts, whose shares in it stay.
  void draw(std::span<const Part> parts, Frame* frame) const {
    const Image shown = reflected_of(*frame, parts);
    std::array<Image, 2> found, smooth;
    for (size_t h = 0; h < 2; ++h) {
      found[h] = found_by(halves[h], parts, drawn, shown);
      smooth[h] = denoise_reflected(denoiser, guides, found[h], {frame->albedo, frame->mean_normal},
                                    image::OidnQuality::Balanced);
    }
    const std::vector<float> weight = weights_by_kind(found, smooth, shown, drawn, kinds, scale);
    for (size_t k = 0; k < shown.pixels.size(); ++k) {
      const float from = shown.pixels[k];
      if (!drawn[k / 3] || from < kBlack) continue;
      const float to = (smooth[0].pixels[k] + smooth[1].pixels[k]) / 2;
      const float factor = std::max(0.0f, 1 + weight[k / 3] * (to / from - 1));
      for (const Part& part : parts) (frame->*part.layer).pixels[k] *= factor;
    }
  }
};

}  // namespace

Image denoise_reflected(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                        const Image& reflected, const PixelMeans& seen,
                        image::OidnQuality quality) {
  const Image& normal = denoiser.is_oidn() ? seen.normal : guides.normal;
  Image out =
      denoiser.denoise({&reflected, &normal, &guides.position, &seen.albedo, nullptr}, quality);
  for (size_t i = 0; i < guides.pixels(); ++i) {
    if (!guides.mask[i]) out.set_rgb(i, reflected.rgb(i));
  }
  return out;
}

void draw_to_denoised(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                      std::span<const PixelKind> kinds, std::span<const int32_t> paths,
                      const std::array<RadianceLayers, 2>& halves, Frame* frame) {
  LTE_CHECK(guides.pixels() == kinds.size() && kinds.size() == paths.size() &&
                frame->albedo.pixels.size() == 3 * kinds.size() && frame->direct.width > 0 &&
                frame->indirect.width > 0 &&
                frame->mean_normal.pixels.size() == frame->albedo.pixels.size(),
            "denoised paths: pictures of different sizes");
  std::vector<uint8_t> drawn(kinds.size());
  for (size_t i = 0; i < drawn.size(); ++i)
    drawn[i] = guides.mask[i] && paths[i] > 0 && kinds[i] != PixelKind::Fixed;
  const Drawing drawing{denoiser, guides, kinds, drawn, halves, relative_scale(*frame)};
  drawing.draw(std::array{kDirect, kIndirect}, frame);
  bool smooth = false;
  for (size_t i = 0; i < drawn.size(); ++i) smooth |= drawn[i] && kinds[i] == PixelKind::Smooth;
  if (smooth) drawing.draw(std::array{kIndirect}, frame);
}

}  // namespace lte::infer
