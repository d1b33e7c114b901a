// Diffuse light between scene points, solved on the points themselves: what models read that have
// their light solved (lte/radiosity/point_radiosity.h).
#pragma once

#include <cstdint>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// Columns of what solve_light() returns.
struct SolvedColumn {
  static constexpr int64_t kDirect = 0, kIndirect = 3, kDirectBack = 6, kIndirectBack = 9,
                           kCount = 12;
};

/// Irradiance in W/m² at every point: direct and indirect on both sides together, then of each the
/// share on the side that the normal leaves. 0 at points that emit.
///
/// @param position  [M, 3] float32, contiguous, finite, metres; likewise
/// @param normal    [M, 3] unit,
/// @param albedo    [M, 3],
/// @param emission  [M, 3] radiance in W sr^-1 m^-2 towards the side of the normal, and
/// @param area      [M] m² that each point stands for
/// @return  [M, 12] float32 on the device of `position`; SolvedColumn names its columns
/// @throws c10::Error on a wrong shape, dtype, layout or device, or, on the CPU, what is not finite
/// @note On the CPU the values of radiosity::solve(), whatever the number of threads. On CUDA
///       rounding may decide otherwise whether two points see each other: some pairs in a million.
///       The host lays out what blocks the view. Not differentiable.
at::Tensor solve_light(const at::Tensor& position, const at::Tensor& normal,
                       const at::Tensor& albedo, const at::Tensor& emission,
                       const at::Tensor& area);

}  // namespace lte::ops
