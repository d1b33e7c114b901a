// A picture with its layers, and what it shows.
#pragma once

#include <cstdint>

#include "lte/base/enum_names.h"
#include "lte/image/image.h"

namespace lte::render {

enum class Output { Full, Gi, Irradiance, Direct, Albedo, Normal, Depth };
constexpr EnumNames<Output, 7> enum_names(Output) {
  return {{{Output::Full, "full"},
           {Output::Gi, "gi"},
           {Output::Irradiance, "irradiance"},
           {Output::Direct, "direct"},
           {Output::Albedo, "albedo"},
           {Output::Normal, "normal"},
           {Output::Depth, "depth"}}};
}

/// Whether there is no light in it.
constexpr bool is_geometry(Output output) {
  return output == Output::Albedo || output == Output::Normal || output == Output::Depth;
}

/// Linear values, means over pixels, [height, width, 3]; an image that the output did not need is
/// empty (width 0). Background is 0 in all but `color` and `emission`, which show the environment.
///
/// In every pixel emission + albedo/pi * (direct + indirect) is the full picture. Metal has the
/// irradiance under which a matt surface of its albedo would look alike; an albedo below 1e-4 is
/// then raised to that.
struct Frame {
  image::Image color;  ///< the chosen output; depth has one channel
  image::Image albedo;
  image::Image normal;  ///< unit; 0 in the background
  image::Image depth;   ///< [height, width, 1], metres along the camera's axis
  image::Image emission;
  image::Image direct;  ///< irradiance, W/m²; empty without PictureSettings::layers
  /// Irradiance by all later bounces; without PictureSettings::layers all reflected light.
  image::Image indirect;
  /// Indirect irradiance as an integrator found it, noisy, at the surface that each pixel's center
  /// sees: without bias by the denoiser, other surfaces in the pixel, or paths that correct it.
  image::Image gathered_indirect;
  int64_t background = 0;    ///< pixels that see no surface
  int64_t metal_pixels = 0;  ///< that whole paths have rendered as some of them is metal
  /// Sums over the pixels that see a surface: how metallic it is, and that of materials that are so
  /// by glTF's default (scene/metal.h).
  double metal = 0, metal_by_default = 0;
};

}  // namespace lte::render
