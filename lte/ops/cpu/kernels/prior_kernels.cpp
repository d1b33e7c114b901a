// Weighted means over the neighbours of a query. The neighbours are in the lanes: they are gathered
// into columns first, and each column is then a few vectors long.
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {
namespace {

using Float = Vector<float>;
constexpr int64_t kMax = kMaxPriorNeighbours, kChannels = kPriorLight;

/// The neighbours of one query, by column; lanes past the last neighbour hold zeros.
struct Neighbours {
  float offset[3][kMax], normal[3][kMax], light[kChannels][kMax];
  float counted[kMax];     ///< 1 for a neighbour
  float error[kMax];       ///< relative, where points have one
  float other[kChannels];  ///< sum of the light on sides that are not read
  float distance2[kMax], height[kMax], facing[kMax], gray[kMax], weight[kMax];
};

/// The row of the side of point j that faces as `normal` does.
int64_t side_of(const PriorPoints& points, int64_t j, const float* normal) {
  const float* const n = points.normal + 6 * j;
  const float front = n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2],
              back = n[3] * normal[0] + n[4] * normal[1] + n[5] * normal[2];
  return 2 * j + (back > front ? 1 : 0);
}

void gather(const PriorPoints& points, const int64_t* index, int64_t K, const float* position,
            const float* normal, Neighbours& near) {
  for (int64_t c = 0; c < kChannels; ++c) near.other[c] = 0;
  for (int64_t i = 0; i < K; ++i) {
    const int64_t j = index[i], side = side_of(points, j, normal);
    for (int64_t c = 0; c < 3; ++c) {
      near.offset[c][i] = points.position[3 * j + c] - position[c];
      near.normal[c][i] = points.normal[3 * side + c];
    }
    for (int64_t c = 0; c < kChannels; ++c) near.light[c][i] = points.light[kChannels * side + c];
    if (points.error != nullptr) near.error[i] = points.error[side];
    const float* const other = points.light + kChannels * (4 * j + 1 - side);
    for (int64_t c = 0; c < kChannels; ++c) near.other[c] += other[c];
  }
}

/// PriorColumn::kNoise from the weights that are there.
float noise_of(const Neighbours& near, int64_t K, float part) {
  Float squares{};
  for (int64_t i = 0; i < K; i += kLanes<float>) {
    const Float e = load(near.weight + i) * load(near.gray + i) * load(near.error + i);
    squares += e * e;
  }
  return horizontal_sum(squares) * part * part;
}

Float dot(const float (*a)[kMax], int64_t i, const float* b) {
  return load(a[0] + i) * splat(b[0]) + load(a[1] + i) * splat(b[1]) + load(a[2] + i) * splat(b[2]);
}

void means_of_query(Neighbours& near, int64_t K, const float* normal, const PriorWeights& weights,
                    float* out) {
  constexpr int kStep = kLanes<float>;
  const float share = 1.0f / static_cast<float>(K);
  Float distance2{}, facing{}, height{}, gray{};
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
    store(near.gray + i, g);
    distance2 += d2;
    height += h;
    facing += f;
    gray += g;
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
  static_assert(PriorColumn::kLight == 0);
  for (int64_t c = 0; c < kChannels; ++c)
    out[c] = (horizontal_sum(sum[c]) + weights.least * near.other[c]) * part;
  const Float mean = splat((out[0] + out[1] + out[2]) * (1.0f / 3));
  Float variance{};
  for (int64_t i = 0; i < K; i += kStep) {
    const Float d = load(near.gray + i) - mean;
    variance += load(near.weight + i) * d * d;
  }
  out[PriorColumn::kVariance] = horizontal_sum(variance) * part;
  out[PriorColumn::kWeight] = weight;
  out[PriorColumn::kFacing] = horizontal_sum(facing) * share;
  out[PriorColumn::kHeight] = horizontal_sum(height) * share / __builtin_sqrtf(scale);
  out[PriorColumn::kGray] = horizontal_sum(gray) * share;
  out[PriorColumn::kDistance2] = scale;
}

void means(PriorPoints points, PriorQueries queries, PriorWeights weights, float* out) {
  const int64_t K = queries.K, columns = kPriorMeans + (points.error != nullptr ? 1 : 0);
  Neighbours near = {};
  for (int64_t i = 0; i < K; ++i) near.counted[i] = 1;
  for (int64_t q = 0; q < queries.count; ++q) {
    const float* const normal = queries.normal + 3 * q;
    float* const row = out + columns * q;
    gather(points, queries.index + q * K, K, queries.position + 3 * q, normal, near);
    means_of_query(near, K, normal, weights, row);
    if (points.error != nullptr)
      row[PriorColumn::kNoise] = noise_of(near, K, 1.0f / row[PriorColumn::kWeight]);
  }
}

/// Logarithms of 16 numbers at a time: what a row has of them, in two arrays.
void features(const float* means, int64_t count, int64_t columns, PriorScales scales, float* out) {
  using Column = PriorColumn;
  constexpr int64_t kLogs = 16;
  static_assert(kChannels + 3 <= kLogs);
  const auto least = static_cast<float>(scales.least_mean), log = static_cast<float>(scales.log),
             shift = static_cast<float>(scales.log_shift);
  float more[kLogs] = {}, plain[kLogs];
  for (float& value : plain) value = 1;
  for (int64_t q = 0; q < count; ++q, means += columns, out += columns) {
    const float g = (means[0] + means[1] + means[2]) * (1.0f / 3);
    const float inverse = 1.0f / (g + least);
    for (int64_t c = 0; c < kChannels; ++c) more[c] = means[c];
    more[Column::kVariance] = __builtin_sqrtf(means[Column::kVariance]) * inverse;
    more[kChannels + 1] = means[Column::kGray];
    more[kChannels + 2] = g;
    plain[0] = means[Column::kWeight];
    plain[1] = means[Column::kDistance2];
    for (int64_t i = 0; i < kLogs; i += kLanes<float>)
      store(more + i, logarithm_of_one_more(load(more + i)));
    const Float two = logarithm(load(plain));
    for (int64_t c = 0; c <= Column::kVariance; ++c) out[c] = more[c];
    out[Column::kWeight] = two[0] / log;
    out[Column::kFacing] = means[Column::kFacing];
    out[Column::kHeight] = means[Column::kHeight];
    out[Column::kGray] = more[kChannels + 1] - more[kChannels + 2];
    out[Column::kDistance2] = (two[1] + shift) / log;
    if (columns > kPriorMeans)
      out[Column::kNoise] = __builtin_sqrtf(means[Column::kNoise]) * inverse;
    for (int64_t i = kChannels + 3; i < kLogs; ++i) more[i] = 0;
  }
}

}  // namespace

extern const PriorKernels kPriorKernels;
const PriorKernels kPriorKernels{means, features};

}  // namespace lte::ops::LTE_ISA
