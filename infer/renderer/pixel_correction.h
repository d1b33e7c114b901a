// A picture of gathered light or by the network corrected by paths through whole pixels, as the
// reference spreads them: what edges, textures, shadows and the answers have lost comes back, so
// that with more paths the picture tends to the reference.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "infer/picture/frame.h"
#include "infer/picture/surface_guides.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

/// What a pixel is to its correction.
enum class PixelKind : uint8_t {
  Smooth,  ///< one surface, which it shares with its neighbours
  Rough,   ///< at an edge, or what reflects nothing at its centre: it stands alone
  Fixed,   ///< it stays as it is
};

/// @param hits        of the guides' pixels
/// @param keep_metal  metal stays as it is: it is shown as something else
std::vector<PixelKind> pixel_kinds(const pathtrace::GBuffer& hits, float pixel_size,
                                   bool keep_metal);

/// One over what each pixel shows, and a tenth of the picture's mean: errors times it count by what
/// an eye would make of them.
std::vector<float> relative_scale(const Frame& frame);

/// @param guides  what the frame's pixels see
/// @param kinds   likewise
/// @param paths   of each pixel; what has none stays as it is
/// @param halves  what they found: means, independent of each other and of the frame
/// @param frame   whose emission, albedo, direct and indirect layers are corrected; not its color
void correct_pixels(const SurfaceGuides& guides, std::span<const PixelKind> kinds,
                    std::span<const int32_t> paths,
                    const std::array<pathtrace::RadianceLayers, 2>& halves, Frame* frame);

}  // namespace lte::infer
