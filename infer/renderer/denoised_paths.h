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

/// Light that surfaces send to the camera, without its noise. What lamps and the background send
/// is none of it, as it would run over their edges.
/// @param reflected  [height, width, 3] radiance
/// @param albedo     [height, width, 3]: of the guides' pixels, or better their means over pixels
/// @return           as it is where the guides see no surface
image::Image denoise_reflected(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                               const image::Image& reflected, const image::Image& albedo,
                               image::OidnQuality quality = image::OidnQuality::High);

/// Draws the frame's direct and indirect layers towards paths without their noise. Both pictures
/// have errors of their own: the one those of gathered light, the other those of the denoiser. Each
/// half of the paths is denoised by itself, so that the other half tells without bias how far the
/// way from frame to denoised picture goes towards the truth: weights are those of the least
/// squared error, in squares of 33 pixels. What is left is for correct_pixels(). It then meets an
/// answer that has some of the paths' noise, which makes the products of its halves smaller: it
/// believes less, not more.
/// @param kinds, paths, halves  as of correct_pixels(); pixels without paths stay as they are
void draw_to_denoised(const image::Denoiser& denoiser, const SurfaceGuides& guides,
                      std::span<const PixelKind> kinds, std::span<const int32_t> paths,
                      const std::array<pathtrace::RadianceLayers, 2>& halves, Frame* frame);

}  // namespace lte::infer
