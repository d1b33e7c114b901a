// Textures from the pictures of scene files.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/scene/import/ignored_features.h"
#include "lte/scene/import/load_budget.h"
#include "lte/scene/scene.h"

namespace lte::scene {

/// A picture as it lies in a file.
struct EncodedPicture {
  std::span<const std::byte> bytes;
  std::string where;      ///< file and element, for messages
  bool srgb = true;       ///< of colors; false for values that are linear as they stand
  bool optional = false;  ///< a scene goes without it if it is damaged
};

/// Decodes PNG, JPEG, WebP, TGA and BMP, told apart by content, in parallel; alpha is dropped.
/// Sizes are read from every header, and counted, before anything is decoded.
/// @return  null for damaged ones that are optional: drop_damaged() comes next
/// @throws lte::Error naming the picture: none of these formats, damaged, animated; OverLimit for
/// one that is too large, alone or with the others.
std::vector<std::shared_ptr<const Texture>> decode_textures(
    const std::vector<EncodedPicture>& pictures, LoadBudget* budget);

/// Takes null textures out of the list, and out of the materials whose normal maps they are.
void drop_damaged(std::vector<std::shared_ptr<const Texture>>* textures,
                  std::vector<Material>* materials, IgnoredFeatures* ignored);

}  // namespace lte::scene
