// Where surfaces meet: there irradiance changes within a few pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/gi/pixel_surfaces.h"

namespace lte::gi {

/// Pixels at most `radius` columns and rows from a contact: a pair of neighbouring pixels that see
/// each other's surface (a concave crease, a foot on a floor) and lie within a few pixels' edges of
/// each other. What stands behind another thing's outline is no contact.
/// @return [height * width], 1 near a contact; only pixels of the mask make one. Empty for a
///         negative radius.
std::vector<uint8_t> find_contacts(const PixelSurfaces& surfaces, int radius);

}  // namespace lte::gi
