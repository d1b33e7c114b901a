// Internal: what paths compute lane by lane without looking anything up, compiled for several
// instruction sets (vector_clones.h).
#pragma once

#include <cstdint>

#include "lte/pathtrace/path_block.h"

namespace lte::pathtrace {

/// Where the Sobol points of some lanes come from.
struct SobolLanes {
  const uint32_t* index;  ///< [count] place in the sequence
  const int32_t* set;     ///< [count] randomized point set
  int count;
  uint32_t last_index;  ///< none is larger
};

/// out[i]: coordinate `dimension` of Sobol point index[i], scrambled with seeds[set[i]]; 32 bits.
void scrambled_sobol(const SobolLanes& lanes, int dimension, const uint32_t* seeds, uint32_t* out);

/// out[i] = owen_scramble(index[i], seeds[set[i]]) & mask: a permutation of a set that keeps its
/// aligned blocks together.
void shuffled_indices(const SobolLanes& lanes, const uint32_t* seeds, uint32_t mask, uint32_t* out);

/// out[i]: number `counter` of the stream that starts at keys[i] (SplitMix64); 32 bits.
void independent_numbers(const uint64_t* keys, int count, uint64_t counter, uint32_t* out);

/// Cosine-distributed unit directions around `normal` from the numbers u and v, 32 bits each, and
/// their solid-angle densities, cosine / π.
void cosine_directions(const uint32_t* u, const uint32_t* v, int count, const Lanes3& normal,
                       Lanes3* direction, float* pdf);

/// Light samples at diffuse surfaces, weighted by the balance heuristic:
/// value = throughput × radiance × cosine / π / density, zero where nothing arrives.
/// @param radiance  in; `value` out
/// @param light_pdf  as LightSample::pdf; negated for delta lights, which nothing else can meet
void weigh_diffuse(const Lanes3& throughput, const Lanes3& normal, const Lanes3& direction,
                   const float* light_pdf, int count, Lanes3* radiance);

/// Russian roulette by the largest channel: scales the throughput of survivors.
/// @param survives  [count] 0 or 1
void play_roulette(const uint32_t* u, int count, Lanes3* throughput, int32_t* survives);

}  // namespace lte::pathtrace
