// Distances, selection and ranking of points. Compiled with contraction off: see kernels.h.
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace lte::ops::LTE_ISA {
namespace {

using Float = Vector<float>;
using Int = Vector<int32_t>;
constexpr int kWidth = kLanes<float>;

struct Query {
  Float x, y, z;
  explicit Query(const float* p) : x(splat(p[0])), y(splat(p[1])), z(splat(p[2])) {}

  Float distance(const float* px, const float* py, const float* pz) const {
    const Float dx = load(px) - x, dy = load(py) - y, dz = load(pz) - z;
    return (dx * dx + dy * dy) + dz * dz;
  }
};

void distances(const float* x, const float* y, const float* z, int64_t count, const float* point,
               float* out) {
  const Query query(point);
  for (int64_t i = 0; i < count; i += kWidth) store(out + i, query.distance(x + i, y + i, z + i));
}

int64_t select(const float* value, int64_t count, float bound, int32_t* out) {
  int64_t found = 0;
#if defined(__AVX512F__)
  __m512i position = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int64_t i = 0; i < count; i += 16) {
    const auto tail = static_cast<__mmask16>(count - i < 16 ? (1u << (count - i)) - 1 : 0xffffu);
    const __mmask16 keep = _mm512_mask_cmp_ps_mask(tail, _mm512_loadu_ps(value + i),
                                                   _mm512_set1_ps(bound), _CMP_LE_OQ);
    // Compressed in a register: compressing straight to memory is slow on some processors.
    _mm512_storeu_si512(out + found, _mm512_maskz_compress_epi32(keep, position));
    found += __builtin_popcount(keep);
    position = _mm512_add_epi32(position, _mm512_set1_epi32(16));
  }
#else
  for (int64_t i = 0; i < count; ++i) {
    out[found] = static_cast<int32_t>(i);
    found += value[i] <= bound ? 1 : 0;
  }
#endif
  return found;
}

void ranks(const float* value, const int32_t* id, int64_t count, int32_t* rank) {
  for (int64_t i = 0; i < count; i += kWidth) {
    const Float mine = load(value + i);
    const Int my_id = load(id + i);
    Int before{};
    for (int64_t j = 0; j < count; ++j) {
      const Float other = splat(value[j]);
      before -= (other < mine) | ((other == mine) & (splat(id[j]) < my_id));
    }
    store(rank + i, before);
  }
}

float relax(const float* x, const float* y, const float* z, int64_t count, const float* point,
            float* distance, int64_t* farthest) {
  const Query query(point);
  Float largest = splat(-1.0f);
  int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) {
    const Float old = load(distance + i), now = query.distance(x + i, y + i, z + i);
    const Float nearer = now < old ? now : old;
    store(distance + i, nearer);
    largest = nearer > largest ? nearer : largest;
  }
  float best = -1.0f;
  for (int lane = 0; lane < kWidth; ++lane) best = largest[lane] > best ? largest[lane] : best;
  if (i < count) {  // the entries past the end belong to another bucket
    const Float now = query.distance(x + i, y + i, z + i);
    for (int lane = 0; i + lane < count; ++lane) {
      float& old = distance[i + lane];
      if (now[lane] < old) old = now[lane];
      if (old > best) best = old;
    }
  }
  int64_t first = 0;
  while (distance[first] != best) ++first;
  *farthest = first;
  return best;
}

int64_t reached(const float* box, int64_t stride, int64_t count, const float* point,
                const float* reach, int32_t* out) {
  const Query query(point);
  const Float zero{};
  int64_t found = 0;
  const auto outside = [&](const float* low, const Float& p) {
    const Float below = load(low) - p, above = p - load(low + 3 * stride);
    const Float d = below > above ? below : above;
    return d > zero ? d : zero;
  };
  for (int64_t i = 0; i < count; i += kWidth) {
    const Float dx = outside(box + i, query.x), dy = outside(box + stride + i, query.y),
                dz = outside(box + 2 * stride + i, query.z);
    const Float d = (dx * dx + dy * dy) + dz * dz;
#if defined(__AVX512F__)
    unsigned mask = _mm512_cmp_ps_mask(d, load(reach + i), _CMP_LT_OQ);
#else
    const Int less = d < load(reach + i);
    unsigned mask = 0;
    for (int lane = 0; lane < kWidth; ++lane) mask |= (less[lane] & 1u) << lane;
#endif
    for (; mask != 0; mask &= mask - 1) {
      out[found++] = static_cast<int32_t>(i + __builtin_ctz(mask));
    }
  }
  return found;
}

}  // namespace

extern const PointKernels kPointKernels;
const PointKernels kPointKernels{distances, select, ranks, relax, reached};

}  // namespace lte::ops::LTE_ISA
