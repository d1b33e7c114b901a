// Directly reflected light of a scene, blurred over space, from which blurred_direct is made.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "infer/light/points.h"

namespace lte::infer {

/// At most `limit` indices spread evenly over [0, count).
std::vector<int64_t> spread(int64_t count, int64_t limit);

/// A few hundred points of a scene with the light they reflect, albedo × direct irradiance. Query
/// points are stratified by area, so an even subset is a fair sample of the surfaces.
class BlurSources {
 public:
  BlurSources(const QueryPoints& points, std::span<const Rgb> direct);

  /// Gaussian-weighted mean of the reflected light around each position; the plain mean where all
  /// weights vanish.
  std::vector<Rgb> blur(std::span<const Vec3> positions, double sigma_m) const;

 private:
  std::vector<Vec3> position_;
  std::vector<Rgb> reflected_;
  Rgb mean_;
};

}  // namespace lte::infer
