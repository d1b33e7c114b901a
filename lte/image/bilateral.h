// A cross-bilateral filter for light on surfaces: what denoises where Open Image Denoise is
// missing.
//
// It is the à-trous filter of Dammertz et al. 2010 with the weights of SVGF (Schied et al. 2017):
// passes of 5 x 5 taps whose distance doubles. A tap counts if both points lie in each other's
// plane and under a similar normal, so that no edge of the geometry is crossed, and by how much
// its value differs, measured in the standard error of the noise, so that shadows stay.
#pragma once

#include "lte/image/image.h"

namespace lte::image {

/// What the filter is guided by: pictures of the noisy one's size. Background has normal 0.
struct BilateralGuides {
  const Image* normal = nullptr;    ///< [height, width, 3] unit
  const Image* position = nullptr;  ///< [height, width, 3], in any one unit of length
  /// [height, width, 1]: variance of each pixel's luminance, where it is known; not finite where
  /// it is not. What is missing, or all of it without this picture, is estimated from neighbours.
  const Image* variance = nullptr;
};

struct BilateralOptions {
  int passes = 5;  ///< taps reach 2 (2^passes − 1) pixels to each side
  /// Standard errors by which luminance may differ: more smooths more.
  float luminance_sigma = 4;
};

/// @param noisy  [height, width, 3], finite
/// @return       the filtered picture; background stays as it is. Does not depend on threads.
/// @throws lte::Error if a guide is missing or of another size, or an option is out of range.
Image bilateral_filter(const Image& noisy, const BilateralGuides& guides,
                       const BilateralOptions& options = {});

}  // namespace lte::image
