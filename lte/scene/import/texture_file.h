// Textures from the pictures of scene files.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/scene/import/load_budget.h"
#include "lte/scene/texture.h"

namespace lte::scene {

/// A picture as it lies in a file.
struct EncodedPicture {
  std::span<const std::byte> bytes;
  std::string where;  ///< file and element, for messages
  bool srgb = true;   ///< of colors; false for values that are linear as they stand
};

/// Decodes PNG, JPEG, WebP, TGA and BMP, told apart by content, in parallel; alpha is dropped.
/// Sizes are read from every header, and counted, before anything is decoded.
/// @throws lte::Error naming the picture: none of these formats, damaged, animated; OverLimit for
/// one that is too large, alone or with the others.
std::vector<std::shared_ptr<const Texture>> decode_textures(
    const std::vector<EncodedPicture>& pictures, LoadBudget* budget);

}  // namespace lte::scene
