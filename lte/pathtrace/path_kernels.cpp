#include "lte/pathtrace/path_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "lte/base/random.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/low_discrepancy.h"
#include "lte/pathtrace/vector_clones.h"

namespace lte::pathtrace {
namespace {

/// Bit-reversed Sobol points by dimension and by byte of the index: a point is the exclusive or of
/// at most four entries, of one in sets of up to 256.
struct SobolTable {
  std::array<std::array<std::array<uint32_t, 256>, 4>, kSobolDimensions> value{};

  SobolTable() {
    for (size_t d = 0; d < kSobolDimensions; ++d) {
      for (size_t byte = 0; byte < 4; ++byte) {
        for (uint32_t entry = 1; entry < 256; ++entry) {
          const auto bit = static_cast<size_t>(std::countr_zero(entry));
          value[d][byte][entry] =
              value[d][byte][entry & (entry - 1)] ^ kSobolMatrix[8 * byte + bit][d];
        }
      }
    }
  }
};

const SobolTable& sobol_table() {
  static const SobolTable table;
  return table;
}

}  // namespace

LTE_VECTOR_CLONES
void scramble_points(const uint32_t* __restrict table, const uint32_t* __restrict index,
                     const int32_t* __restrict set, const uint32_t* __restrict seeds, int count,
                     uint32_t* __restrict out) {
  for (int i = 0; i < count; ++i)
    out[i] = reverse_bits(scramble_reversed(table[index[i]], seeds[set[i]]));
}

LTE_VECTOR_CLONES
void scramble_long_points(const uint32_t* __restrict table, const uint32_t* __restrict index,
                          const int32_t* __restrict set, const uint32_t* __restrict seeds,
                          int count, uint32_t* __restrict out) {
  for (int i = 0; i < count; ++i) {
    const uint32_t k = index[i];
    const uint32_t point = table[k & 255] ^ table[256 + ((k >> 8) & 255)] ^
                           table[512 + ((k >> 16) & 255)] ^ table[768 + (k >> 24)];
    out[i] = reverse_bits(scramble_reversed(point, seeds[set[i]]));
  }
}

void scrambled_sobol(const SobolLanes& lanes, int dimension, const uint32_t* seeds, uint32_t* out) {
  const uint32_t* table = sobol_table().value[static_cast<size_t>(dimension)][0].data();
  (lanes.last_index < 256 ? scramble_points : scramble_long_points)(table, lanes.index, lanes.set,
                                                                    seeds, lanes.count, out);
}

LTE_VECTOR_CLONES
void shuffle_lanes(const uint32_t* __restrict index, const int32_t* __restrict set,
                   const uint32_t* __restrict seeds, int count, uint32_t mask,
                   uint32_t* __restrict out) {
  for (int i = 0; i < count; ++i) out[i] = owen_scramble(index[i], seeds[set[i]]) & mask;
}

void shuffled_indices(const SobolLanes& lanes, const uint32_t* seeds, uint32_t mask,
                      uint32_t* out) {
  shuffle_lanes(lanes.index, lanes.set, seeds, lanes.count, mask, out);
}

LTE_VECTOR_CLONES
void independent_numbers(const uint64_t* __restrict keys, int count, uint64_t counter,
                         uint32_t* __restrict out) {
  for (int i = 0; i < count; ++i)
    out[i] = static_cast<uint32_t>(mix_bits(keys[i] + counter * 0x9e3779b97f4a7c15ULL) >> 32);
}

LTE_VECTOR_CLONES
void cosine_directions(const uint32_t* __restrict u, const uint32_t* __restrict v, int count,
                       const Lanes3& __restrict normal, Lanes3* __restrict direction,
                       float* __restrict pdf) {
  for (int i = 0; i < count; ++i) {
    const Vec3 d = cosine_direction({normal.x[i], normal.y[i], normal.z[i]},
                                    {to_unit(u[i]), to_unit(v[i])}, pdf + i);
    direction->x[i] = d.x, direction->y[i] = d.y, direction->z[i] = d.z;
  }
}

LTE_VECTOR_CLONES
void weigh_diffuse(const Lanes3& __restrict throughput, const Lanes3& __restrict normal,
                   const Lanes3& __restrict direction, const float* __restrict light_pdf, int count,
                   Lanes3* __restrict radiance) {
  for (int i = 0; i < count; ++i) {
    const float cosine =
        normal.x[i] * direction.x[i] + normal.y[i] * direction.y[i] + normal.z[i] * direction.z[i];
    const float bsdf_pdf = cosine * (1 / kPi);
    const float pdf = light_pdf[i];
    const float density = pdf < 0 ? -pdf : pdf + bsdf_pdf;
    const float weight = (pdf != 0) & (cosine > 0) ? bsdf_pdf / density : 0.0f;
    radiance->x[i] = throughput.x[i] * radiance->x[i] * weight;
    radiance->y[i] = throughput.y[i] * radiance->y[i] * weight;
    radiance->z[i] = throughput.z[i] * radiance->z[i] * weight;
  }
}

LTE_VECTOR_CLONES
void play_roulette(const uint32_t* __restrict u, int count, Lanes3* __restrict throughput,
                   int32_t* __restrict survives) {
  for (int i = 0; i < count; ++i) {
    float probability = std::max(throughput->x[i], throughput->y[i]);
    probability = std::max(probability, throughput->z[i]);
    const float scale = probability < 1 ? 1 / probability : 1.0f;
    survives[i] = to_unit(u[i]) < probability ? 1 : 0;
    throughput->x[i] *= scale;
    throughput->y[i] *= scale;
    throughput->z[i] *= scale;
  }
}

}  // namespace lte::pathtrace
