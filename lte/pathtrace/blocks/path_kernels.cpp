#include "lte/pathtrace/blocks/path_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "lte/base/random.h"
#include "lte/base/vector_clones.h"
#include "lte/pathtrace/balance_heuristic.h"
#include "lte/pathtrace/blocks/low_discrepancy.h"
#include "lte/pathtrace/blocks/square_to_triangle.h"
#include "lte/pathtrace/materials/lambert.h"

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

/// For sets of up to 256 points, of which one entry of the table makes each.
LTE_VECTOR_CLONES
void scramble_points(const uint32_t* __restrict table, const uint32_t* __restrict index,
                     const int32_t* __restrict set, const uint32_t* __restrict seeds, int count,
                     uint32_t* __restrict out) {
  for (int i = 0; i < count; ++i)
    out[i] = reverse_bits(scramble_reversed(table[index[i]], seeds[set[i]]));
}

/// For sets of any size.
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
    const Vec3 d = sample_lambert({normal.x[i], normal.y[i], normal.z[i]},
                                  {to_unit(u[i]), to_unit(v[i])}, pdf + i);
    direction->x[i] = d.x;
    direction->y[i] = d.y;
    direction->z[i] = d.z;
  }
}

LTE_VECTOR_CLONES
void draw_entries(const float* __restrict threshold, const float* __restrict probabilities,
                  const uint32_t* __restrict alias, uint32_t size, const uint32_t* __restrict u,
                  int count, uint32_t* __restrict entry, float* __restrict probability) {
  alignas(64) float within[kBlock];
  for (int i = 0; i < count; ++i) {
    entry[i] = static_cast<uint32_t>((uint64_t{u[i]} * size) >> 32);
    within[i] = to_unit(u[i] * size);  // what is left of the product
  }
  for (int i = 0; i < count; ++i) {
    const uint32_t cell = entry[i], other = alias[cell];
    const uint32_t drawn = within[i] < threshold[cell] ? cell : other;
    entry[i] = drawn;
    probability[i] = probabilities[drawn];
  }
}

void draw_entries(const AliasColumns& table, const uint32_t* u, int count, uint32_t* entry,
                  float* probability) {
  draw_entries(table.threshold, table.probability, table.alias, table.size, u, count, entry,
               probability);
}

/// All branches are selections, so that lanes stay together. The columns are TriangleLight's
/// floats.
LTE_VECTOR_CLONES
void sample_triangles(const float* __restrict lights, const uint32_t* __restrict entry,
                      const float* __restrict probability, const uint32_t* __restrict u,
                      const uint32_t* __restrict v, int count, const Lanes3& __restrict position,
                      LightBlock* __restrict out) {
  constexpr uint32_t kStride = sizeof(TriangleLight) / sizeof(float);
  constexpr float kMax = std::numeric_limits<float>::max();
  for (int i = 0; i < count; ++i) {
    const uint32_t at = entry[i] * kStride;
    const auto vector = [lights, at](uint32_t k) {
      return Vec3{lights[at + k], lights[at + k + 1], lights[at + k + 2]};
    };
    const Vec3 b = square_to_triangle({to_unit(u[i]), to_unit(v[i])});
    const Vec3 n = vector(9);
    Vec3 offset = vector(0) + vector(3) * b.y + vector(6) * b.z -
                  Vec3{position.x[i], position.y[i], position.z[i]};
    const Rgb emission = vector(12);
    const float area = lights[at + 15], apart = lights[at + 16], back = lights[at + 17];
    const float height = -dot(n, offset), side = std::copysign(1.0f, height);
    offset += n * (side * apart);
    const float distance2 = dot(offset, offset), distance = std::sqrt(distance2);
    const Vec3 direction = offset * (1 / distance);
    const float cosine = -side * dot(n, direction);
    float pdf = distance2 / (area * cosine) * probability[i];
    pdf = std::max(height, -height * back) > 0 ? pdf : 0.0f;  // on a side that emits,
    pdf = cosine > 0 ? pdf : 0.0f;  // farther than the offset, which would turn the side around,
    pdf = pdf <= kMax ? pdf : 0.0f;
    out->direction.x[i] = direction.x;
    out->direction.y[i] = direction.y;
    out->direction.z[i] = direction.z;
    out->radiance.x[i] = emission.x;
    out->radiance.y[i] = emission.y;
    out->radiance.z[i] = emission.z;
    out->distance[i] = distance;
    out->pdf[i] = pdf;
  }
}

void sample_triangles(const TriangleLight* lights, const uint32_t* entry, const float* probability,
                      const uint32_t* u, const uint32_t* v, int count, const Lanes3& position,
                      LightBlock* out) {
  static_assert(sizeof(TriangleLight) == 18 * sizeof(float));
  sample_triangles(&lights->p0.x, entry, probability, u, v, count, position, out);
}

LTE_VECTOR_CLONES
void weigh_diffuse(const Lanes3& __restrict normal, const Lanes3& __restrict direction,
                   const float* __restrict pdf, int count, float* __restrict weight) {
  for (int i = 0; i < count; ++i) {
    const float cosine =
        normal.x[i] * direction.x[i] + normal.y[i] * direction.y[i] + normal.z[i] * direction.z[i];
    const float bsdf_pdf = lambert_pdf(cosine);
    const float ratio = bsdf_pdf / balance_density(pdf[i], bsdf_pdf);
    weight[i] = ((pdf[i] != 0) & (cosine > 0)) ? ratio : 0.0f;
  }
}

LTE_VECTOR_CLONES
void russian_roulette(const uint32_t* __restrict u, int count, Lanes3* __restrict throughput,
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
