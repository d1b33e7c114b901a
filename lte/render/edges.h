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

/// @param film  with one camera ray a pixel
Edges find_edges(const Film& film);

/// Whether an eye sees both as one surface.
bool same_surface(const SurfacePlace& a, const SurfacePlace& b);
/// Whether the irradiance at one is about that at the other, if they are near each other.
bool shares_light(const SurfacePlace& a, const SurfacePlace& b);

/// The pixel whose light stands for that of a hit in a pixel: of those near it the one whose center
/// is the nearest on the same surface, by its place in kNearPixels; -1 if there is none.
int light_source(const Film& film, size_t pixel, const SurfacePlace& hit);

}  // namespace lte::render
