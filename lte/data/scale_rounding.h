// What counts as fitting into the scale of a data set or of a model.
#pragma once

namespace lte::data {

/// Points drawn on a scene that is just as wide as its scale may lie beyond it by rounding: by less
/// than this share of the scale, which counts as fitting.
inline constexpr double kScaleRounding = 1e-5;

}  // namespace lte::data
