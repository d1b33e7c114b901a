// Textures from the pictures of scene files.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/scene/import/limits.h"
#include "lte/scene/texture.h"

namespace lte::scene {

/// A picture as it lies in a file.
struct EncodedPicture {
  std::span<const std::byte> bytes;
  std::string where;  ///< file and element, for messages
  bool srgb = true;   ///< of colors; false for values that are linear as they stand
};

/// Decodes PNG, JPEG, WebP, TGA and BMP, told apart by content, in parallel; alpha is dropped.
/// Sizes are read from every header, and held against the limits, before anything is decoded.
/// @throws lte::Error naming the picture: none of these formats, damaged, animated, or larger than
/// the limits of one texture or of all.
std::vector<std::shared_ptr<const Texture>> decode_textures(
    const std::vector<EncodedPicture>& pictures, const LoadLimits& limits);

}  // namespace lte::scene
