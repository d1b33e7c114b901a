// Directions drawn in proportion to a map over the cells of a hemisphere (hemisphere_bins.h), by
// inverting the distribution over its cells.
#pragma once

#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"

namespace lte::experiments {

/// Radiance over the cells of a hemisphere, such as a radiance decoder answers.
struct DirectionMap {
  std::span<const Rgb> radiance;  ///< [bins * bins] in any unit, finite, not negative
  int bins = 0;                   ///< even
  Vec3 normal;                    ///< unit, the hemisphere's
};

/// Whether a draw is by the first of two ways, which has so large a share of draws; `u` in [0, 1)
/// becomes the number that the way itself draws with.
bool takes_first(float share, float* u);

/// How likely each cell is. It holds no surface, so surfaces that are near to one another may
/// share one.
class GuideTable {
 public:
  /// Cells in proportion to their luminance: radiance times cosine, as cells have equal projected
  /// solid angle.
  /// @param even_share  of draws, spread evenly over the cells, so that none has density zero
  /// @throws lte::Error if sizes disagree, a value is negative or not finite, or the share is not
  ///         in (0, 1]
  GuideTable(const DirectionMap& map, float even_share);

  /// The same with a factor on each cell: `factor(direction)`, world, finite and not negative.
  template <typename Factor>
  GuideTable(const DirectionMap& map, float even_share, const Factor& factor)
      : GuideTable(map.bins, map.normal) {
    check(map, even_share);
    std::vector<double> weight(map.radiance.size());
    for (size_t i = 0; i < weight.size(); ++i)
      weight[i] = luminance(map.radiance[i] * factor(centre(i)));
    fill(weight, even_share);
  }

  /// Solid-angle density of sample(); 0 below the hemisphere.
  float pdf(const Vec3& direction) const;

  /// @param u  of the unit square  @return  world, unit
  Vec3 sample(const Vec2& u) const;

  /// Height of a direction over the hemisphere's ground: the cosine to its normal.
  float height(const Vec3& direction) const { return dot(direction, frame_.normal()); }

 private:
  GuideTable(int bins, const Vec3& normal) : bins_(bins), frame_(normal) {}
  static void check(const DirectionMap& map, float even_share);
  void fill(const std::vector<double>& weight, float even_share);
  /// Direction that stands for a cell, world.
  Vec3 centre(size_t cell) const;

  int bins_;
  pathtrace::BinFrame frame_;
  std::vector<float> share_;   ///< [cells] probability of each, which add up to 1
  std::vector<double> below_;  ///< [cells] of all up to and with it
};

}  // namespace lte::experiments
