// Ways to draw the points that describe a scene, from many more candidates that lie evenly by area.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/enum_names.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {

enum class PointDraw { Area, Farthest, Light, SmallObjects, Triangles };

constexpr EnumNames<PointDraw, 5> enum_names(PointDraw) {
  return {{{PointDraw::Area, "area"},
           {PointDraw::Farthest, "farthest"},
           {PointDraw::Light, "light"},
           {PointDraw::SmallObjects, "small-objects"},
           {PointDraw::Triangles, "triangles"}}};
}

/// Draws about `count` distinct rows so that each is drawn with a probability in proportion to its
/// weight, 1 at most, by a single variate and equal steps along the rows (systematic sampling).
/// @param weights      not negative, one above 0
/// @param probability  of each row
std::vector<size_t> draw_weighted(std::span<const double> weights, int64_t count, Rng* rng,
                                  std::vector<double>* probability);

/// Keeps about `count` of the candidates. Points of luminaires and skies are thinned evenly
/// whatever the draw. Areas become what the points kept stand for: over its probability, or, of
/// Farthest, that of the candidates nearest to each.
/// @param draw  Area: evenly. Farthest: farthest point sampling. Light: by irradiance of a few
///              paths. SmallObjects: by one over the root of an instance's area, a bias as the
///              paper tried. Triangles: as many on each triangle.
scene::SurfaceSamples draw_points(PointDraw draw, const pathtrace::Bvh& bvh,
                                  const pathtrace::Lights& lights,
                                  const scene::SurfaceSamples& candidates, int64_t count,
                                  uint64_t seed);

}  // namespace lte::experiments
