// Which samples stay once it is known what light reaches, and what area each then stands for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// Indices of samples, in order.
struct KeptSamples {
  std::vector<size_t> luminaires;  ///< of emissive surfaces, which stay
  std::vector<size_t> lost;        ///< of those, what shines at nothing (orientation.h): they leave
  std::vector<size_t> others;

  int64_t size() const { return static_cast<int64_t>(luminaires.size() + others.size()); }
};

/// Reduces `samples` to `count` of those that are kept, or to all of them if they are fewer.
///
/// Of `others` some leave, evenly, and the areas of the rest are scaled so that their sum stays.
/// Points of luminaires leave only where they would be more than half of `count` and there are
/// others to take their place: then each luminaire keeps its share of the half, at least one point.
///
/// The areas of a luminaire's points are scaled so that, with those of its lost ones, they sum to
/// its faces' area, and if some others left, further so that Σ emission · area over its points
/// stays.
void reduce_samples(const scene::Scene& scene, KeptSamples kept, int64_t count,
                    scene::SurfaceSamples* samples);

}  // namespace lte::pathtrace
