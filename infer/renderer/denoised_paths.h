// Paths without their noise: a denoised picture of what they found, by itself, and as what a
// gathered picture is drawn towards.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "infer/picture/frame.h"
#include "infer/picture/surface_guides.h"
#include "infer/renderer/pixel_correction.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

/// What the pixels of a picture see, [height, width, 3]: at centres, or better means over pixels.
struct PixelMeans {
  const image::Image &albedo, &normal;
};

/// Light that surfaces send to the camera, without its noise. What lamps and the background send
/// is none of it, as it would run over their edges.
/// @param reflected  [height, width, 3] radiance
/// @param seen       guides Open Image Denoise; other filters take the guides' own normals
/// @return           as it is where the guides see no surface
image::Image denoise_reflected(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                               const image::Image& reflected, const PixelMeans& seen,
                               image::OidnQuality quality = image::OidnQuality::High);

/// Draws the frame's direct and indirect layers towards paths without their noise. Both pictures
/// have errors of their own: the one those of gathered light, the other those of the denoiser. Each
/// half of the paths is denoised by itself, so that the other half tells without bias how far the
/// way from frame to denoised picture goes towards the truth: weights are those of the least
/// squared error, in squares of 33 pixels. First the sum of both layers is drawn, then the indirect
/// one by itself, which few rays know less well and a denoiser that sees no shadows better
/// (docs/lab/final.md); not where surfaces have no paths, as it takes as long again. What is left
/// is for correct_pixels(). It then meets an answer that has some of the paths' noise, which makes
/// the products of its halves smaller: it believes less, not more.
/// @param kinds, paths, halves  as of correct_pixels(); pixels without paths stay as they are
/// @param frame  with its mean normals, whose layers are drawn; not its color
void draw_to_denoised(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                      std::span<const PixelKind> kinds, std::span<const int32_t> paths,
                      const std::array<pathtrace::RadianceLayers, 2>& halves, Frame* frame);

}  // namespace lte::infer
