// Which texels are neighbours on the surfaces of the world, wherever their charts lie.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"

namespace lte::bake {

/// Places that light is known at. Every array has an entry a place.
struct GraphPlaces {
  std::span<const Vec3> position, normal;  ///< unit, of the side that is lit
  std::span<const float> edge;             ///< metres that the place stands for
  std::span<const uint8_t> skipped;        ///< not 0: is nobody's neighbour
};

/// Neighbours of each place: those within kReach of its edge, on the same side of the same sheet,
/// with nothing between. Whoever is a neighbour has the other as one.
class TexelGraph {
 public:
  TexelGraph(const pathtrace::Bvh& bvh, const GraphPlaces& places);

  size_t size() const { return first_.size() - 1; }
  std::span<const uint32_t> neighbours(size_t place) const {
    return std::span(other_).subspan(first_[place], first_[place + 1] - first_[place]);
  }
  /// Means over each place and its neighbours, `times` over: a smooth kernel of as many texels of
  /// variance, which walls, corners and the ends of surfaces stop.
  /// @tparam Value  float or Rgb
  template <typename Value>
  std::vector<Value> spread(std::vector<Value> values, int times) const;

 private:
  std::vector<uint32_t> first_, other_;
};

}  // namespace lte::bake
