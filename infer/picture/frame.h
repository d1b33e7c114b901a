// A rendered picture with its layers.
#pragma once

#include <cstdint>

#include "lte/image/image.h"

namespace lte::infer {

/// What a render gave. An image that the output did not need is empty (width 0). Background pixels
/// are zero in all.
///
/// Albedo and emission are means over the pixel's hits, normal and depth are those of its centre.
/// Light layers are weighted by albedo, so that in every pixel emission + albedo/π · (direct +
/// indirect) is the picture; those of Output::Irradiance are means over the pixel, without weights.
/// A pixel of path-traced metal has the light layers under which a matt surface of its albedo would
/// look alike; an albedo below 10⁻⁴ is then raised to that.
struct Frame {
  image::Image color;  ///< the chosen output, linear; depth has one channel
  image::Image albedo, normal, depth, emission;
  /// Over the hits of a pixel, 0 where they meet nothing: not unit at edges. Only if asked for.
  image::Image mean_normal;
  image::Image direct;    ///< irradiance by direct light, W/m²
  image::Image indirect;  ///< irradiance by all later bounces
  /// Irradiance of a model whose target is the total, when direct light was not needed.
  image::Image total;
  /// Of Output::Attention: multiples of an even share (attention_map.h), 1 channel.
  image::Image attention;
  int64_t background = 0;  ///< pixels whose centre meets nothing
  int64_t queries = 0;     ///< points that reflect light and that the network may be asked for
  /// Those that the network has answered, fewer if it is asked sparsely; or that rays were gathered
  /// at.
  int64_t decoded = 0;
  int64_t edge_pixels = 0;      ///< pixels with several hits
  double correction_paths = 0;  ///< a pixel, that have corrected the picture, on average
  /// In neural mode, pixels with metal that paths have rendered, and all that reflect light where
  /// paths answer for indirect light.
  int64_t traced_pixels = 0;
  /// Sums over the pixels that see a surface: how metallic it is, and that of materials that are so
  /// by glTF's default (scene/metal.h).
  double metal = 0, metal_by_default = 0;
};

}  // namespace lte::infer
