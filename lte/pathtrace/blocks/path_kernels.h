// Internal: what paths compute lane by lane without looking anything up, compiled for several
// instruction sets (vector_clones.h).
#pragma once

#include <cstdint>

#include "lte/pathtrace/blocks/path_block.h"

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

/// An emissive triangle as samples of it need it (EmissiveTriangle, lights.h): floats alone, so
/// that lanes can gather them.
struct TriangleLight {
  Vec3 p0, edge1, edge2, normal;
  Rgb emission;
  float area, offset;
  float back;  ///< 1 if it emits from its back too, else 0
};

/// The columns of an alias table (alias_table.h).
struct AliasColumns {
  const float *threshold, *probability;
  const uint32_t* alias;
  uint32_t size;
};

/// Draws entries with one number of 32 bits each.
void draw_entries(const AliasColumns& table, const uint32_t* u, int count, uint32_t* entry,
                  float* probability);

/// Points on the triangles `entry` from the numbers u and v, seen from `position`.
/// @param probability  with which the triangle was chosen
void sample_triangles(const TriangleLight* lights, const uint32_t* entry, const float* probability,
                      const uint32_t* u, const uint32_t* v, int count, const Lanes3& position,
                      LightBlock* out);

/// What light samples are multiplied by at diffuse surfaces of albedo 1, by the balance heuristic:
/// cosine / π / density, 0 where nothing arrives.
/// @param pdf  as LightBlock::pdf
void weigh_diffuse(const Lanes3& normal, const Lanes3& direction, const float* pdf, int count,
                   float* weight);

/// Russian roulette by the largest channel: scales the throughput of survivors.
/// @param survives  [count] 0 or 1
void russian_roulette(const uint32_t* u, int count, Lanes3* throughput, int32_t* survives);

}  // namespace lte::pathtrace
