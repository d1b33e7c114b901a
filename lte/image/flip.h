// FLIP: the error that a person sees when flipping between two pictures (Andersson et al. 2020,
// "FLIP: A Difference Evaluator for Alternating Images"), and its form for high dynamic range
// (Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images").
#pragma once

#include <cstdint>
#include <span>

#include "lte/image/image.h"

namespace lte::image {

/// Pixels per degree of visual angle of a 0.7 m wide screen of 3840 pixels seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67.0206432765823;

/// FLIP of two pictures in linear Rec.709, clamped to [0, 1].
///
/// @param a, reference     of one size and 3 channels, any size from one pixel on
/// @param pixels_per_degree  of the viewer; the filters' radii grow with it
/// @return                 one channel, in [0, 1]; 0 where the pictures look alike
/// @throws lte::Error if sizes differ, there are not 3 channels, or `pixels_per_degree` is not
/// positive.
/// @note Pixels beyond the border are those of the border. The result has the same bits for any
/// number of threads.
Image flip(const Image& a, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

/// The exposures, in stops, at which HDR-FLIP looks: from the one that brings the brightest
/// luminance of the reference to 0.85 under the ACES curve, to the one that brings the median
/// there.
struct FlipExposures {
  double start = 0, stop = 0;
  int count = 2;  ///< evenly spaced, both ends included
};

/// @param mask  if not empty, [height, width]: only pixels with a non-zero entry are looked at
FlipExposures flip_exposures(const Image& reference, std::span<const uint8_t> mask = {});

/// HDR-FLIP of two pictures of linear radiance: the greatest FLIP of each pixel over exposures,
/// tone-mapped by Narkowicz's fit of the ACES curve.
/// @throws lte::Error as flip().
Image hdr_flip(const Image& a, const Image& reference, const FlipExposures& exposures,
               double pixels_per_degree = kFlipPixelsPerDegree);

/// The mean of a one-channel picture over the pixels of `mask` (all of them if it is empty); 0 if
/// there are none.
double masked_mean(const Image& scalar, std::span<const uint8_t> mask);

}  // namespace lte::image
