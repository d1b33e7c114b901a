// Pixels that no known pixel stands for (upsample.h): narrow things, and surfaces seen past edges.
// Some of them are answered, and what these say is shared by all around them on their surface: that
// takes fewer answers, and the noise of a single one does not stay in its pixel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/gi/pixel_surfaces.h"

namespace lte::gi {

/// The first of the pixels in each block of `side`² pixels that has any.
/// @param pixels  in the order of the picture
/// @param side    at least 1, which keeps all
std::vector<int32_t> first_of_blocks(const PixelSurfaces& surfaces, std::span<const int32_t> pixels,
                                     int side);

/// Gives each of the pixels the mean of the answers at most `radius` pixels away, by similarity,
/// its own among them.
/// @param answered  per pixel of the picture, not 0 where `layers` have an answer
/// @param layers    [layers][pixel of the picture]
/// @return  the pixels around which there is none on their surface, in order: they stay as they are
/// @note the same for any number of threads.
std::vector<int32_t> share_answers(const PixelSurfaces& surfaces, std::span<const int32_t> pixels,
                                   std::span<const uint8_t> answered, int radius,
                                   std::span<const std::span<Rgb>> layers);

}  // namespace lte::gi
