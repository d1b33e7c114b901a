// Where samples that go on over several calls take their random numbers from.
#pragma once

#include <cstdint>

namespace lte::pathtrace {

/// A point's next samples, in a point set that a tile of 8 x 8 places shares
/// (blocks/tile_sequence.h).
struct SampleNumber {
  uint64_t set = 0;     ///< sets of different numbers are independent
  uint32_t place = 0;   ///< of the point in its tile, row by row; below 64
  uint32_t number = 0;  ///< samples that the place has had
};

}  // namespace lte::pathtrace
