// What pixels of a scene see, and what paths and light samples bring them, with its spread.
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/guiding/guide.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/scene/scene.h"

namespace lte::experiments {

/// A surface, and where it is seen from.
struct Sight {
  Vec3 position, normal;
  Reflector reflector;
};

/// Through the middles of the pixels of a picture, in rows; what reflects nothing is left out.
std::vector<Sight> look(const pathtrace::Bvh& bvh, const scene::Camera& camera, int width,
                        int height);

/// Mean and variance of what one path or one light sample brings towards the camera, in luminance.
struct Statistics {
  double mean = 0, variance = 0;

  /// Of a sum of two that are drawn apart.
  friend Statistics operator+(const Statistics& a, const Statistics& b) {
    return {a.mean + b.mean, a.variance + b.variance};
  }
};

class Moments {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
  }
  /// @param count  values, those of 0 included that nobody added
  Statistics of(int64_t count) const;

 private:
  double sum_ = 0, squares_ = 0;
};

/// What a path brings by its indirect light, and by all that it finds: luminance.
struct Brought {
  double indirect = 0, whole = 0;
};
/// @param at  one of the samples, of density above 0
Brought brought(const IncidentSamples& samples, size_t at, const Guide& material);

/// Of paths: their indirect light, and all that they find.
struct PathStatistics {
  Statistics indirect, whole;
};
PathStatistics statistics_of(const IncidentSamples& samples, const Guide& material);

/// Direct light by one light sample and its shadow ray, of so many.
Statistics light_samples(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const Sight& sight, const Guide& material, int64_t count, Rng* rng);

}  // namespace lte::experiments
