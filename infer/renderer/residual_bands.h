// What two independent halves of paths say of an answer's error, apart from their noise.
//
// A residual is what paths found less the answer. It is split into bands, from a pixel's width to
// that of a room's wall, by smoothing over surfaces (à-trous wavelets). In every band and place the
// product of both halves has no noise in its mean: it is the power of the error. Their difference
// is the noise's. The band is kept by the share that the error has of both (Wiener's filter): not
// at all where paths are few or the answer is right, wholly where they are many. A power is
// believed by how far it stands out of its own standard error, or few paths would add what chance
// has made of them. So what is left is never much more than the lesser of the answer's error and
// the paths' noise, and it has no floor. A fault of a few pixels, such as the rim of a lamp,
// decides for itself: it says nothing of the pixels around, where it would let the paths' grain in.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lte/image/image.h"

namespace lte::infer {

struct ResidualHalves {
  image::Image a, b;  ///< [height, width, 3]
};

/// Where residuals are smoothed: pictures of their size.
struct ResidualSurfaces {
  const image::Image& normal;     ///< [height, width, 3] unit
  const image::Image& position;   ///< [height, width, 3]
  std::span<const uint8_t> mask;  ///< per pixel, not 0 where there are residuals
};

/// What is to be added to the answers, [height, width, 3] each, 0 outside of the mask.
/// @param residuals  of one picture each; they are used up
/// @param check      called between passes; what it throws ends it. May be null.
std::vector<image::Image> error_of(std::vector<ResidualHalves> residuals,
                                   const ResidualSurfaces& surfaces,
                                   const std::function<void()>& check = {});

/// The same in one band, that of single pixels: where they share no surface.
/// @param scale  per pixel, what statistics multiply a residual by; empty for 1
image::Image error_of_pixels(const ResidualHalves& residual, std::span<const uint8_t> mask,
                             std::span<const float> scale);

}  // namespace lte::infer
