// Internal: the Sobol sequence as the points of a tile of 8 x 8 places share it.
//
// Its first two dimensions are the place in the tile: of 64 consecutive points one lies at each
// place. So what a place draws, point after point, is spread evenly, and so is what neighbours have
// drawn together, however many of them have come how far (Grünschloß, Raab and Keller, "Enumerating
// quasi-Monte Carlo point sequences in elementary intervals", 2012).
#pragma once

#include <array>
#include <cstdint>

#include "lte/base/random.h"
#include "lte/pathtrace/blocks/low_discrepancy.h"
#include "lte/pathtrace/sample_number.h"

namespace lte::pathtrace {

inline constexpr uint32_t kTileEdge = 8, kTilePlaces = kTileEdge * kTileEdge;
/// Dimensions that the place takes.
inline constexpr int kTileDimensions = 2;

/// Where a point of the sequence lies, row by row.
constexpr uint32_t tile_place(uint32_t index) {
  constexpr int kRest = 29;  // bits below the three that tell one of eight
  uint32_t x = 0, y = 0;
  for (uint32_t bit = 0; index >> bit != 0; ++bit) {
    if (((index >> bit) & 1) == 0) continue;
    x ^= kSobolMatrix[bit][0];
    y ^= kSobolMatrix[bit][1];
  }
  return (reverse_bits(y) >> kRest) * kTileEdge + (reverse_bits(x) >> kRest);
}

/// Of the first points, the one at each place.
inline constexpr auto kFirstOfPlaces = [] {
  std::array<uint32_t, kTilePlaces> out{};
  for (uint32_t i = 0; i < kTilePlaces; ++i) out[tile_place(i)] = i;
  return out;
}();

/// The `number`-th point, from 0, of the sequence at a place.
constexpr uint32_t tile_index(uint32_t number, uint32_t place) {
  const uint32_t first = number * kTilePlaces;
  return first + kFirstOfPlaces[tile_place(first) ^ place];
}

/// What a pixel or texel draws that has drawn `number` samples of the same stream.
inline SampleNumber sample_number(uint64_t stream, uint32_t x, uint32_t y, uint32_t number) {
  const uint64_t tile = uint64_t{y / kTileEdge} << 32 | x / kTileEdge;
  return {hash_combine(stream, tile), y % kTileEdge * kTileEdge + x % kTileEdge, number};
}

}  // namespace lte::pathtrace
