// lte_render --output incident: radiance by direction at one surface point, by the network and by
// paths, side by side.
#pragma once

#include <span>
#include <string>

#include "infer/render/render_request.h"
#include "lte/base/math.h"
#include "lte/image/image.h"

namespace lte::infer {

/// Two maps of bins × bins cells (hemisphere_bins.h, row 0 on top), `left` beside `right`, a column
/// of zeros of the width of a cell between them.
image::Image maps_side_by_side(std::span<const Rgb> left, std::span<const Rgb> right, int bins);

/// Writes the picture of --out, the network's map on the left, and prints what they differ by.
/// @throws lte::Error for bad input, a model without a radiance decoder, or flags that do not go
///         with a map
void run_incident_map(const RenderRequest& request);

}  // namespace lte::infer
