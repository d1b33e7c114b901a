// Pixels at edges, which need more samples than others: where a camera ray through the middle of
// one of the four pixels beside it sees something else.
#pragma once

#include <vector>

#include "lte/render/film.h"

namespace lte::render {

struct Edges {
  std::vector<size_t> surface;  ///< another surface: background, another plane or normal
  std::vector<size_t> color;    ///< another albedo of the same surface
  /// Something that shines unlike, also across corners: a lamp is a hundred times as bright as what
  /// is beside it, so its share of a pixel is most of a picture's squared error. These pixels may
  /// be among the others, too.
  std::vector<size_t> lamp;
};

/// @param film        with one camera ray a pixel
/// @param pixel_size  edge of what a pixel covers at depth 1 (pathtrace::pixel_size())
Edges find_edges(const Film& film, float pixel_size);

}  // namespace lte::render
