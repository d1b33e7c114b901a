// Weighted means over the neighbours of a query. The neighbours are in the lanes: they are gathered
// into columns first, and each column is then a few vectors long.
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {
namespace {

using Float = Vector<float>;
constexpr int64_t kMost = kMostCacheNeighbours, kChannels = kCacheLight;

/// The neighbours of one query, by column; lanes past the last neighbour hold zeros.
struct Neighbours {
  float offset[3][kMost], normal[3][kMost], light[kChannels][kMost];
  float counted[kMost];  ///< 1 for a neighbour
  float distance2[kMost], height[kMost], facing[kMost], grey[kMost], weight[kMost];
};

void gather(const CachePoints& points, const int64_t* index, int64_t K, const float* position,
            Neighbours& near) {
  for (int64_t i = 0; i < K; ++i) {
    const int64_t j = index[i];
    for (int64_t c = 0; c < 3; ++c) {
      near.offset[c][i] = points.position[3 * j + c] - position[c];
      near.normal[c][i] = points.normal[3 * j + c];
    }
    for (int64_t c = 0; c < kChannels; ++c) near.light[c][i] = points.light[kChannels * j + c];
  }
}

Float dot(const float (*a)[kMost], int64_t i, const float* b) {
  return load(a[0] + i) * splat(b[0]) + load(a[1] + i) * splat(b[1]) + load(a[2] + i) * splat(b[2]);
}

void means_of_query(Neighbours& near, int64_t K, const float* normal, const CacheWeights& weights,
                    float* out) {
  constexpr int kStep = kLanes<float>;
  const float share = 1.0f / static_cast<float>(K);
  Float distance2{}, facing{}, height{}, grey{};
  for (int64_t i = 0; i < K; i += kStep) {
    Float d2{};
    for (int c = 0; c < 3; ++c) d2 += load(near.offset[c] + i) * load(near.offset[c] + i);
    const Float h = dot(near.offset, i, normal), n = dot(near.normal, i, normal);
    const Float f = n > Float{} ? n : Float{};
    const Float g = (load(near.light[0] + i) + load(near.light[1] + i) + load(near.light[2] + i)) *
                    splat(1.0f / 3);
    store(near.distance2 + i, d2);
    store(near.height + i, h);
    store(near.facing + i, f);
    store(near.grey + i, g);
    distance2 += d2;
    height += h;
    facing += f;
    grey += g;
  }
  float scale = horizontal_sum(distance2) * share;
  scale = scale > weights.least_distance2 ? scale : weights.least_distance2;
  const Float inverse = splat(-1.0f / scale);
  Float total{}, sum[kChannels] = {};
  for (int64_t i = 0; i < K; i += kStep) {
    const Float h = load(near.height + i), f = load(near.facing + i), f2 = f * f;
    const Float exponent =
        (load(near.distance2 + i) * splat(weights.near) + h * h * splat(weights.plane)) * inverse;
    const Float weight =
        (f2 * f2 * exponential(exponent) + splat(weights.least)) * load(near.counted + i);
    store(near.weight + i, weight);
    total += weight;
    for (int64_t c = 0; c < kChannels; ++c) sum[c] += weight * load(near.light[c] + i);
  }
  const float weight = horizontal_sum(total), part = 1.0f / weight;
  static_assert(CacheColumn::kLight == 0);
  for (int64_t c = 0; c < kChannels; ++c) out[c] = horizontal_sum(sum[c]) * part;
  const Float mean = splat((out[0] + out[1] + out[2]) * (1.0f / 3));
  Float variance{};
  for (int64_t i = 0; i < K; i += kStep) {
    const Float d = load(near.grey + i) - mean;
    variance += load(near.weight + i) * d * d;
  }
  out[CacheColumn::kVariance] = horizontal_sum(variance) * part;
  out[CacheColumn::kWeight] = weight;
  out[CacheColumn::kFacing] = horizontal_sum(facing) * share;
  out[CacheColumn::kHeight] = horizontal_sum(height) * share / __builtin_sqrtf(scale);
  out[CacheColumn::kGrey] = horizontal_sum(grey) * share;
  out[CacheColumn::kDistance2] = scale;
}

void means(CachePoints points, CacheQueries queries, CacheWeights weights, float* out) {
  const int64_t K = queries.K;
  Neighbours near = {};
  for (int64_t i = 0; i < K; ++i) near.counted[i] = 1;
  for (int64_t q = 0; q < queries.count; ++q) {
    gather(points, queries.index + q * K, K, queries.position + 3 * q, near);
    means_of_query(near, K, queries.normal + 3 * q, weights, out + kCacheMeans * q);
  }
}

}  // namespace

extern const CacheKernels kCacheKernels;
const CacheKernels kCacheKernels{means};

}  // namespace lte::ops::LTE_ISA
