// From linear pictures that are no light to what the page shows: albedo, normals, signed
// differences.
#pragma once

#include <cstdint>
#include <vector>

#include "infer/view/view_state.h"
#include "lte/image/display_picture.h"
#include "lte/image/image.h"

namespace lte::infer::view {

using image::DisplayPicture;

/// Albedo through sRGB alone.
DisplayPicture display_albedo(const image::Image& albedo);

/// Normals of [-1, 1] as colors; the zero normal of background stays black.
DisplayPicture display_normal(const image::Image& normal);

/// `light` - `reference`, exposed: red where there is too much light, blue where too little, by
/// luminance, in full color from a quarter of the range of the display on; black where they agree.
DisplayPicture display_difference(const image::Image& light, const image::Image& reference,
                                  float exposure);

}  // namespace lte::infer::view
