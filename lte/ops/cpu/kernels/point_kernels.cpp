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

/// A bit for each lane that is set; those past `count` are not.
unsigned bits_of(const Int& lanes, int64_t count) {
#if defined(__AVX512F__)
  const unsigned bits = _mm512_movepi32_mask((__m512i)lanes);
#else
  unsigned bits = 0;
  for (int lane = 0; lane < kWidth; ++lane) bits |= (lanes[lane] & 1u) << lane;
#endif
  return count < kWidth ? bits & ((1u << count) - 1) : bits;
}

float farthest(const float* x, const float* y, const float* z, int64_t count, const float* point) {
  const Query query(point);
  Float most{};
  int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) {
    const Float d = query.distance(x + i, y + i, z + i);
    most = d > most ? d : most;
  }
  float largest = 0;
  for (int lane = 0; lane < kWidth; ++lane) largest = most[lane] > largest ? most[lane] : largest;
  if (i < count) {
    const Float d = query.distance(x + i, y + i, z + i);
    for (int lane = 0; i + lane < count; ++lane) largest = d[lane] > largest ? d[lane] : largest;
  }
  return largest;
}

/// Squared distances to the boxes from `i` on. Every step rounds monotonically and in the order of
/// Query::distance(), so none exceeds that of a point inside.
Float box_distances(const BoxLevel& level, int64_t i, const Query& query) {
  const auto outside = [&](int axis, const Float& p) {
    const float* low = level.box + axis * level.stride + i;
    const Float below = load(low) - p, above = p - load(low + 3 * level.stride), zero{};
    const Float d = below > above ? below : above;
    return d > zero ? d : zero;
  };
  const Float dx = outside(0, query.x), dy = outside(1, query.y), dz = outside(2, query.z);
  return (dx * dx + dy * dy) + dz * dz;
}

/// near() of points [begin, end), after the `found` ones.
int64_t add_near(const float* x, const float* y, const float* z, int64_t begin, int64_t end,
                 const Query& query, const Float& limit, int64_t found, float* distance,
                 int32_t* position) {
  for (int64_t i = begin; i < end; i += kWidth) {
    const Float d = query.distance(x + i, y + i, z + i);
    const unsigned kept = bits_of(d <= limit, end - i);
#if defined(__AVX512F__)
    const Int here = splat(static_cast<int32_t>(i)) +
                     (Int)_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    // Compressed in a register: compressing straight to memory is slow on some processors.
    const auto mask = static_cast<__mmask16>(kept);
    store(distance + found, (Float)_mm512_maskz_compress_ps(mask, (__m512)d));
    store(position + found, (Int)_mm512_maskz_compress_epi32(mask, (__m512i)here));
    found += __builtin_popcount(kept);
#else
    for (int lane = 0; lane < kWidth; ++lane) {
      distance[found] = d[lane];
      position[found] = static_cast<int32_t>(i) + lane;
      found += kept >> lane & 1u;
    }
#endif
  }
  return found;
}

int64_t near(const float* x, const float* y, const float* z, int64_t count, const float* point,
             float bound, float* distance, int32_t* position) {
  return add_near(x, y, z, 0, count, Query(point), splat(bound), 0, distance, position);
}

int64_t within(PointBoxes points, const float* point, float bound, float* distance,
               int32_t* position) {
  const Query query(point);
  const Float limit = splat(bound);
  struct Run {
    int64_t begin, end;  ///< boxes
    int level;
  };
  Run stack[PointBoxes::kBoxesOfOne * PointBoxes::kMaxLevels];
  stack[0] = {0, points.level[points.levels - 1].count, points.levels - 1};
  int64_t found = 0;
  for (int depth = 1; depth > 0;) {
    const Run run = stack[--depth];
    const BoxLevel level = points.level[run.level];
    for (int64_t i = run.begin; i < run.end; i += kWidth) {
      unsigned met = bits_of(box_distances(level, i, query) <= limit, run.end - i);
      for (; met != 0; met &= met - 1) {
        const int64_t box = i + __builtin_ctz(met);
        if (run.level == 0) {
          found = add_near(points.x, points.y, points.z, points.begin[box], points.end[box], query,
                           limit, found, distance, position);
          continue;
        }
        const int64_t first = box * PointBoxes::kBoxesOfOne, past = first + PointBoxes::kBoxesOfOne,
                      count = points.level[run.level - 1].count;
        stack[depth++] = {first, past < count ? past : count, run.level - 1};
      }
    }
  }
  return found;
}

/// Counts of lesser values for `VECTORS` vectors from `mine` on.
template <int VECTORS>
void count_lesser(const float* value, int64_t count, const float* mine, int32_t* rank) {
  Float own[VECTORS];
  Int before[VECTORS] = {};
#pragma GCC unroll 4
  for (int v = 0; v < VECTORS; ++v) own[v] = load(mine + v * kWidth);
  for (int64_t j = 0; j < count; ++j) {
    const Float other = splat(value[j]);
#pragma GCC unroll 4
    for (int v = 0; v < VECTORS; ++v) before[v] -= other < own[v];
  }
#pragma GCC unroll 4
  for (int v = 0; v < VECTORS; ++v) store(rank + v * kWidth, before[v]);
}

void ranks(const float* value, const int32_t* id, int64_t count, int32_t* rank) {
  int64_t i = 0;
  for (; i + 3 * kWidth < count; i += 4 * kWidth)
    count_lesser<4>(value, count, value + i, rank + i);
  const int64_t left = count - i;
  if (left > 2 * kWidth) {
    count_lesser<3>(value, count, value + i, rank + i);
  } else if (left > kWidth) {
    count_lesser<2>(value, count, value + i, rank + i);
  } else if (left > 0) {
    count_lesser<1>(value, count, value + i, rank + i);
  }
  int64_t sum = 0;
  for (i = 0; i < count; ++i) sum += rank[i];
  if (sum == count * (count - 1) / 2) return;
  // Equal values have counted each other as not before: their sum is too small.
  for (i = 0; i < count; i += kWidth) {
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
  const BoxLevel level{box, stride, count};
  int64_t found = 0;
  for (int64_t i = 0; i < count; i += kWidth) {
    unsigned nearer = bits_of(box_distances(level, i, query) < load(reach + i), count - i);
    for (; nearer != 0; nearer &= nearer - 1) {
      out[found++] = static_cast<int32_t>(i + __builtin_ctz(nearer));
    }
  }
  return found;
}

}  // namespace

extern const PointKernels kPointKernels;
const PointKernels kPointKernels{distances, farthest, near, within, ranks, relax, reached};

}  // namespace lte::ops::LTE_ISA
