// Tone curves: from exposed linear light to what a display can show, before sRGB.
#pragma once

#include "lte/base/enum_names.h"
#include "lte/base/math.h"

namespace lte::image {

/// Linear clips. Reinhard rolls off by luminance and keeps the hue. Filmic (Hable 2010) works by
/// channel and reaches white at 4.
enum class ToneCurve { Linear, Reinhard, Filmic };

/// To [0, 1]; what is negative counts as 0.
Rgb tone_map(ToneCurve curve, const Rgb& exposed);

constexpr EnumNames<ToneCurve, 3> enum_names(ToneCurve) {
  return {{{ToneCurve::Linear, "linear"},
           {ToneCurve::Reinhard, "reinhard"},
           {ToneCurve::Filmic, "filmic"}}};
}

}  // namespace lte::image
