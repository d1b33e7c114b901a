// What paths know better than an answer: a picture of irradiance that converges as they do.
//
// Two independent halves of the paths are compared with the answer. What both say differs from it
// by more than their noise is its error (residual_bands.h), and is added. So with more paths the
// error falls to that of the paths and has no floor.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "infer/picture/surface_guides.h"

namespace lte::infer {

/// @param mask    per pixel, not 0 where the pictures have irradiance
/// @param answer  [height, width, 3], whose noise is independent of that of the halves
/// @param half_a  unbiased irradiance, with independent noise in every pixel
/// @param half_b  likewise, independent of the other half and of the same variance
/// @param check   called between the filter's passes; what it throws ends it. May be null.
/// @return        [height, width, 3], not negative where the answer is not
/// @throws lte::Error if sizes differ.
/// @note The same for any number of threads.
image::Image correct_by_paths(const SurfaceGuides& guides, std::span<const uint8_t> mask,
                              const image::Image& answer, const image::Image& half_a,
                              const image::Image& half_b, const std::function<void()>& check = {});

}  // namespace lte::infer
