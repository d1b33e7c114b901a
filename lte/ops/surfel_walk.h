// The walk of a ray among discs, which the kernels of see_surfels() share. What tests the discs of
// a cell is theirs: loops over lanes on the CPU, a plain loop on CUDA.
//
// Functions of C, and vectors of its own: device code has no others.
#pragma once

#include <cstdint>

#include <math.h>

#include "lte/ops/surfel_columns.h"
#include "lte/ops/triple.h"

namespace lte::ops {

/// SurfelGrid as the walk reads it.
struct SurfelView {
  const float* discs;
  const float* geometry;
  int64_t stride;  ///< of geometry's rows
  const int32_t *first, *member;
  float low[3];
  float cell;
  int size[3];
  Triple ambient;
};

struct SurfelRay {
  Triple origin, direction;
};

/// Discs that lie behind the nearest by less than this share of their radius are one surface with
/// it.
inline constexpr float kSurfelLayer = 0.5f;
/// The variance of a disc's weight, in squares of its radius.
inline constexpr float kSurfelSpread = 0.35f;

/// The discs that a ray has met so far.
struct Meetings {
  static constexpr int kMax = 24;

  float distance[kMax], weight[kMax];
  int32_t disc[kMax];
  bool front[kMax];
  int count = 0;
  float limit = INFINITY;  ///< discs behind it belong to no surface that is seen

  /// @param square  of the distance to the middle
  C10_HOST_DEVICE void add(float at, float square, float radius, int32_t row, bool on_front) {
    if (at > limit) return;
    limit = fminf(limit, at + kSurfelLayer * radius);
    int place = count;
    if (count < kMax) {
      ++count;
    } else {  // the nearest are kept, so that those that are seen are among them
      place = farthest();
      if (at >= distance[place]) return;
    }
    distance[place] = at;
    weight[place] = expf(-square / (radius * radius * kSurfelSpread));
    disc[place] = row;
    front[place] = on_front;
  }

 private:
  C10_HOST_DEVICE int farthest() const {
    int out = 0;
    for (int i = 1; i < kMax; ++i) out = distance[i] > distance[out] ? i : out;
    return out;
  }
};

/// Entry k of a cell as it was put there.
struct PlainCells {
  C10_HOST_DEVICE void test(const SurfelView& grid, int32_t begin, int32_t end,
                            const SurfelRay& ray, float near, float far, Meetings& met) const {
    for (int32_t k = begin; k < end; ++k) {
      const float* at = grid.geometry + k;
      const Triple normal{at[3 * grid.stride], at[4 * grid.stride], at[5 * grid.stride]};
      const float signed_radius = at[6 * grid.stride], radius = fabsf(signed_radius);
      const float toward = dot(ray.direction, normal);
      const Triple offset = Triple{at[0], at[grid.stride], at[2 * grid.stride]} - ray.origin;
      const float distance = dot(offset, normal) / toward;
      // A disc lies in several cells: it counts in that where the ray meets it.
      if (!(distance > kSurfelOwn * radius) || distance < near || distance >= far ||
          distance > met.limit)
        continue;
      const Triple away = ray.direction * distance - offset;
      const float square = dot(away, away);
      if (square >= radius * radius || (toward > 0 && signed_radius < 0)) continue;
      met.add(distance, square, radius, grid.member[k], toward < 0);
    }
  }
};

/// The surface that a ray meets, blended of discs.
struct SurfelLayer {
  Triple place, normal, sent, emission, metal;
  float distance = 0, metallic = 0, roughness = 0, radius = 0;
};

C10_HOST_DEVICE inline SurfelLayer blend(const SurfelView& grid, const SurfelRay& ray,
                                         const Meetings& met) {
  SurfelLayer layer;
  float total = 0;
  for (int i = 0; i < met.count; ++i) {
    if (met.distance[i] > met.limit) continue;
    const float* disc = grid.discs + met.disc[i] * kSurfelColumns;
    const float w = met.weight[i];
    total += w;
    layer.distance += w * met.distance[i];
    layer.normal = layer.normal + triple_at(disc + SurfelColumn::kNormal) * (met.front[i] ? w : -w);
    layer.sent = layer.sent +
                 triple_at(disc + (met.front[i] ? SurfelColumn::kFront : SurfelColumn::kBack)) * w;
    layer.metal = layer.metal + triple_at(disc + SurfelColumn::kMetal) * w;
    layer.metallic += w * disc[SurfelColumn::kMetallic];
    layer.roughness += w * disc[SurfelColumn::kRoughness];
    layer.radius += w * disc[SurfelColumn::kRadius];
    if (met.front[i])
      layer.emission = layer.emission + triple_at(disc + SurfelColumn::kEmission) * w;
  }
  const float share = 1 / total, length = sqrtf(dot(layer.normal, layer.normal));
  layer.distance *= share;
  if (length > 0) layer.normal = layer.normal * (1 / length);
  layer.sent = layer.sent * share;
  layer.emission = layer.emission * share;
  layer.metal = layer.metal * share;
  layer.metallic *= share;
  layer.roughness *= share;
  layer.radius *= share;
  layer.place = ray.origin + ray.direction * layer.distance;
  return layer;
}

/// Whether a ray meets a surface, and which.
template <typename Cells>
C10_HOST_DEVICE bool meet(const SurfelView& grid, const Cells& cells, const SurfelRay& ray,
                          SurfelLayer* layer) {
  const float origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const float direction[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  float enter = 0, leave = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / direction[axis];
    const float high = grid.low[axis] + static_cast<float>(grid.size[axis]) * grid.cell;
    const float a = (grid.low[axis] - origin[axis]) * inverse, b = (high - origin[axis]) * inverse;
    if (a != a || b != b) continue;  // along a face of the grid
    enter = fmaxf(enter, fminf(a, b));
    leave = fminf(leave, fmaxf(a, b));
  }
  if (!(enter < leave)) return false;
  // The distances of the next border along each axis.
  int at[3], step[3];
  float border[3], width[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float d = direction[axis], start = origin[axis] + d * enter - grid.low[axis];
    const int cell = static_cast<int>(start / grid.cell), most = grid.size[axis] - 1;
    at[axis] = cell < 0 ? 0 : cell > most ? most : cell;
    step[axis] = d > 0 ? 1 : -1;
    width[axis] = d != 0 ? grid.cell / fabsf(d) : INFINITY;
    const float next = grid.low[axis] + static_cast<float>(at[axis] + (d > 0 ? 1 : 0)) * grid.cell;
    border[axis] = d != 0 ? (next - origin[axis]) / d : INFINITY;
  }
  Meetings met;
  float begin = -INFINITY;
  while (begin <= met.limit) {
    const int axis =
        border[0] < border[1] ? (border[0] < border[2] ? 0 : 2) : (border[1] < border[2] ? 1 : 2);
    const float end = border[axis];
    const int64_t cell =
        (static_cast<int64_t>(at[2]) * grid.size[1] + at[1]) * grid.size[0] + at[0];
    const int32_t first = grid.first[cell], last = grid.first[cell + 1];
    if (first < last) cells.test(grid, first, last, ray, begin, end, met);
    begin = end;
    at[axis] += step[axis];
    if (at[axis] < 0 || at[axis] >= grid.size[axis]) break;
    border[axis] += width[axis];
  }
  if (met.count == 0) return false;
  *layer = blend(grid, ray, met);
  return true;
}

/// The half vector of GGX at `u` of its cumulative distribution.
C10_HOST_DEVICE inline Triple half_vector(Triple n, float roughness, float u, float turn) {
  const float alpha = roughness * roughness, tangent = alpha * sqrtf(u / (1 - u));
  const float cosine = 1 / sqrtf(1 + tangent * tangent), sine = tangent * cosine;
  // Two vectors that complete the normal to a frame (Duff et al. 2017).
  const float sign = copysignf(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  const Triple x{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x},
      y{b, sign + n.y * n.y * a, -n.y};
  return n * cosine + (x * cosf(turn) + y * sinf(turn)) * sine;
}

/// Where a ray goes on, as from a mirror with the normal `about`.
C10_HOST_DEVICE inline Triple mirrored(Triple direction, Triple about) {
  return direction - about * (2 * dot(direction, about));
}

C10_HOST_DEVICE inline Triple start_of(const SurfelLayer& layer) {
  return layer.place + layer.normal * (kSurfelOwn * layer.radius);
}

/// Less metal than this reflects nothing.
inline constexpr float kMinMetal = 0.02f;
inline constexpr int kReflections = 4, kBounces = 2;

/// What a ray that metal has reflected sees.
template <typename Cells>
C10_HOST_DEVICE Triple follow(const SurfelView& grid, const Cells& cells, SurfelRay ray) {
  Triple sum, share{1, 1, 1};
  for (int bounce = 1;; ++bounce) {
    SurfelLayer layer;
    if (!meet(grid, cells, ray, &layer)) break;
    sum = sum + share * (layer.sent + layer.emission);
    if (!(layer.metallic > kMinMetal)) return sum;
    share = share * layer.metal;
    if (bounce == kBounces) break;
    ray = {start_of(layer), mirrored(ray.direction, layer.normal)};
  }
  return sum + share * grid.ambient;
}

/// What the metal of a layer shows to a ray along `direction`.
template <typename Cells>
C10_HOST_DEVICE Triple reflected(const SurfelView& grid, const Cells& cells,
                                 const SurfelLayer& layer, Triple direction) {
  constexpr float kGoldenAngle = 2.3999632f;
  Triple sum;
  for (int i = 0; i < kReflections; ++i) {
    const float number = static_cast<float>(i), u = (number + 0.5f) / kReflections;
    Triple way =
        mirrored(direction, half_vector(layer.normal, layer.roughness, u, number * kGoldenAngle));
    if (dot(way, layer.normal) <= 0) way = mirrored(direction, layer.normal);
    sum = sum + follow(grid, cells, {start_of(layer), way});
  }
  return layer.metal * sum * (1.0f / kReflections);
}

/// The kSeenColumns that a ray sees.
template <typename Cells>
C10_HOST_DEVICE void see(const SurfelView& grid, const Cells& cells, const SurfelRay& ray,
                         float* columns) {
  // The logarithm of distances, about centred: rooms lie around a fifth of network space.
  constexpr float kDistanceShift = 1.6f, kMinDistance = 1e-4f;
  for (int64_t c = 0; c < kSeenColumns; ++c) columns[c] = 0;
  SurfelLayer layer;
  if (!meet(grid, cells, ray, &layer)) return;
  Triple radiance = layer.sent;
  if (layer.metallic > kMinMetal)
    radiance = radiance + reflected(grid, cells, layer, ray.direction);
  const float channels[3] = {radiance.x, radiance.y, radiance.z};
  for (int c = 0; c < 3; ++c) {
    columns[kSeenRadiance + c] = channels[c];
    columns[kSeenLog + c] = log1pf(channels[c]);
  }
  columns[kSeenHit] = 1;
  columns[kSeenDistance] = logf(fmaxf(layer.distance, kMinDistance)) + kDistanceShift;
  columns[kSeenMetal] = layer.metallic;
  columns[kSeenCosine] = -dot(ray.direction, layer.normal);
}

}  // namespace lte::ops
