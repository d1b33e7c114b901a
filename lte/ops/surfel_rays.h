// What rays see of discs that stand for a scene's points (surfels: Pfister et al. 2000; for light:
// Christensen 2008, "Point-Based Approximate Global Illumination"). The discs lie in a regular
// grid, through which a ray walks cell by cell (Amanatides and Woo 1987).
#pragma once

#include <array>
#include <cstdint>

#include "lte/ops/surfel_columns.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Discs, and which of them reach into which cell.
struct SurfelGrid {
  at::Tensor discs;  ///< [M, kSurfelColumns] float32
  /// [kSurfelGeometry, E and some] float32, of a cell's discs one after the other: position, normal
  /// and radius, which is negative where rays pass the back.
  at::Tensor geometry;
  at::Tensor
      first;  ///< [cells + 1] int32, of each cell the first of its discs among E; x runs first
  at::Tensor member;                     ///< [E] int32, rows of `discs`
  std::array<double, 3> low{};           ///< the least corner of the grid
  std::array<double, 3> ambient{};       ///< mean of what all fronts send out
  double cell = 1;                       ///< edge of a cell
  std::array<int64_t, 3> size{1, 1, 1};  ///< cells along each axis

  bool defined() const { return discs.defined(); }
  std::array<at::Tensor, 4> tensors() const { return {discs, geometry, first, member}; }
};

/// The grid of some discs, on their device.
///
/// @param discs  [M, kSurfelColumns] float32, finite, normals unit
/// @throws c10::Error on a wrong shape or dtype
/// @note Made on the CPU, from where it is copied.
SurfelGrid make_surfel_grid(const at::Tensor& discs);

/// Discs whose middle a ray meets at nearly the nearest distance share the answer, by how near
/// their middles are. Metals reflect the ray: four GGX half vectors at the first, the mirror's
/// direction behind it, at most two bounces. Emission is seen in metal alone.
///
/// @param position    [Q, 3] float32, where rays start: on a surface, whose own discs are passed
/// @param directions  [Q, N, 3] float32, unit
/// @return  [Q, N, kSeenColumns] float32
/// @throws c10::Error on a wrong shape, dtype or device
/// @note Not differentiable. The 24 nearest discs of a ray count at most; each ray's answer depends
///       on no other.
at::Tensor see_surfels(const at::Tensor& position, const at::Tensor& directions,
                       const SurfelGrid& grid);

}  // namespace lte::ops
