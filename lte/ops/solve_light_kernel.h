// What a thread of solve_light() on CUDA does: a march through the grid of what blocks the view,
// the direct light of a point, and what a sender gives to a receiver. The arithmetic is that of
// lte/radiosity, a march at a time.
#pragma once

#include <cstdint>

#include <math.h>

#include "lte/ops/triple.h"
#include "lte/radiosity/constants.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// radiosity::MarkedGrid.
struct BlockedView {
  const int32_t* clearance;  ///< [cells]
  const float* surfels;      ///< [surfels, 6]: middle, normal
  Triple low;
  float cell, inverse;
  int size[3];  ///< 0 where nothing blocks
};

C10_HOST_DEVICE inline bool crosses(const BlockedView& grid, Triple from, Triple to, int32_t mark) {
  const int32_t first = -mark >> 2, count = -mark & 3;
  const float own = radiosity::kOwnCells * grid.cell, radius = radiosity::kRadiusCells * grid.cell;
  for (int32_t i = first; i < first + count; ++i) {
    const Triple middle = triple_at(grid.surfels + 6 * i),
                 normal = triple_at(grid.surfels + 6 * i + 3);
    const Triple a = from - middle;
    const float above = dot(a, normal), below = dot(to - middle, normal);
    if (!(above * below < 0) || !(fminf(fabsf(above), fabsf(below)) > own)) continue;
    const float span = above - below, reach = radius * span;
    const Triple off = a * span + (to - from) * above;
    if (dot(off, off) < reach * reach) return true;
  }
  return false;
}

/// radiosity::march() of one segment.
C10_HOST_DEVICE inline bool sees(const BlockedView& grid, Triple from, Triple to) {
  if (grid.size[0] == 0) return true;
  const Triple start = (from - grid.low) * grid.inverse;
  Triple way = (to - grid.low) * grid.inverse - start;
  const float distance = sqrtf(dot(way, way));
  if (distance > 0) way = {way.x / distance, way.y / distance, way.z / distance};
  const float a[3] = {start.x, start.y, start.z}, d[3] = {way.x, way.y, way.z};
  float at = 0, end = distance;
  for (int axis = 0; axis < 3; ++axis) {
    const float high = static_cast<float>(grid.size[axis]);
    if (d[axis] == 0) {
      if (a[axis] < 0 || a[axis] > high) return true;
      continue;
    }
    const float first = -a[axis] / d[axis], last = (high - a[axis]) / d[axis];
    at = fmaxf(at, fminf(first, last));
    end = fminf(end, fmaxf(first, last));
  }
  int32_t tested = 0;
  while (at <= end) {
    int cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int most = grid.size[axis] - 1, c = static_cast<int>(a[axis] + d[axis] * at);
      cell = cell * grid.size[axis] + (c < 0 ? 0 : c > most ? most : c);
    }
    const int32_t clearance = grid.clearance[cell];
    if (clearance < 0 && clearance != tested && crosses(grid, from, to, clearance)) return false;
    if (clearance < 0) tested = clearance;
    at += fmaxf(static_cast<float>(clearance - 1), radiosity::kStep);
  }
  return true;
}

/// Irradiance here over radiance there, and the sides that light leaves and reaches.
struct Transfer {
  float weight;
  bool from_back, to_back;
};

/// radiosity::Patches::transfer_to() of one patch.
C10_HOST_DEVICE inline Transfer transfer(Triple point, Triple normal, Triple patch, Triple facing,
                                         float area) {
  constexpr float kPi = 3.14159265358979f;
  const Triple d = patch - point;
  const float d2 = dot(d, d), here = dot(d, normal), there = dot(d, facing);
  const float weight = fabsf(here * there) / d2 * area / (d2 + area / kPi);
  return {d2 > 0 ? weight : 0, there > 0, here < 0};
}

/// Points as the kernels read them.
struct LitView {
  const float *position, *normal, *emission;  ///< [M, 3]
  const float* area;                          ///< [M]
  const int64_t* luminaire;                   ///< [L] rows in the order of clusters
  const int64_t* cluster;                     ///< [C + 1] where clusters begin among luminaires
  const float* middle;                        ///< [C, 3]
  int64_t clusters;
  BlockedView grid;
};

/// Direct irradiance at point i, of the front and of the back, [6].
C10_HOST_DEVICE inline void direct_at(const LitView& view, int64_t i, float* light) {
  const Triple point = triple_at(view.position + 3 * i), normal = triple_at(view.normal + 3 * i);
  const auto from = [&](int64_t k) {
    const int64_t j = view.luminaire[k];
    Transfer t = transfer(point, normal, triple_at(view.position + 3 * j),
                          triple_at(view.normal + 3 * j), view.area[j]);
    if (!(t.weight >= radiosity::kMinDirect) || t.from_back) t.weight = 0;
    return t;
  };
  for (int c = 0; c < 6; ++c) light[c] = 0;
  for (int64_t c = 0; c < view.clusters; ++c) {
    const int64_t last = view.cluster[c + 1];
    int64_t k = view.cluster[c];
    while (k < last && from(k).weight == 0) ++k;
    if (k == last || !sees(view.grid, point, triple_at(view.middle + 3 * c))) continue;
    for (; k < last; ++k) {
      const Transfer t = from(k);
      float* side = light + (t.to_back ? 3 : 0);
      for (int channel = 0; channel < 3; ++channel)
        side[channel] += view.emission[3 * view.luminaire[k] + channel] * t.weight;
    }
  }
}

/// What point i receives over the radiosity of a sender, 0 where it sees none of it.
C10_HOST_DEVICE inline Transfer link_of(const LitView& view, int64_t i, int64_t sender,
                                        float sender_area) {
  constexpr float kPi = 3.14159265358979f;
  const Triple point = triple_at(view.position + 3 * i);
  const Triple patch = triple_at(view.position + 3 * sender);
  Transfer t = transfer(point, triple_at(view.normal + 3 * i), patch,
                        triple_at(view.normal + 3 * sender), sender_area);
  const bool kept = t.weight >= radiosity::kMinTransfer && sees(view.grid, point, patch);
  t.weight = kept ? t.weight / kPi : 0;
  return t;
}

}  // namespace lte::ops
