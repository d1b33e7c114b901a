// Scene points as discs that rays meet (surfels: Pfister et al. 2000; for light: Christensen 2008,
// "Point-Based Approximate Global Illumination"). What a ray sees of them, by the light that the
// points are told of, is what the radiance decoder starts from: coarse, without a surface or a
// traced path, and it follows metals from disc to disc.
#pragma once

#include <array>
#include <cstdint>

#include <ATen/core/Tensor.h>

#include "lte/nn/point_set.h"
#include "lte/ops/surfel_rays.h"

namespace lte::nn {

using enum ops::SeenColumn;
using ops::kSeenColumns;
using ops::kSeenFeatures;

/// The discs of a scene.
class Surfels {
 public:
  /// Columns of table().
  using enum ops::SurfelColumn::Name;
  static constexpr int64_t kColumns = ops::kSurfelColumns;

  Surfels() = default;
  /// @param table  [M, kColumns] float32
  /// @param total  whether rays see emission too, not only what bounced
  Surfels(const at::Tensor& table, bool total)
      : grid_(ops::make_surfel_grid(table)), total_(total) {}

  bool defined() const { return grid_.defined(); }
  const at::Tensor& table() const { return grid_.discs; }
  std::array<at::Tensor, 4> tensors() const { return grid_.tensors(); }
  Surfels to(c10::Device device) const { return {table().to(device), total_}; }

  /// @param position    [Q, 3] network space, on a surface
  /// @param directions  [Q, N, 3] unit
  /// @return            [Q, N, kSeenColumns] on their device and in their dtype; no gradients
  at::Tensor see(const at::Tensor& position, const at::Tensor& directions) const;

 private:
  ops::SurfelGrid grid_;
  bool total_ = false;
};

/// The discs of scene points. What their fronts send out is of direct light that they are told of,
/// and of what the irradiance decoder answers there; that of their backs is of what they are told.
///
/// @param position  [M, 3] network space
/// @param scale     metres of a unit of network space
/// @param emission_scale  [3]
/// @param irradiance  [M, 3] the decoder's answers on the fronts, over the emission scale
/// @param config    of a model that reads bounced light
Surfels make_surfels(const PointSet& points, const at::Tensor& position, double scale,
                     const at::Tensor& emission_scale, const at::Tensor& irradiance,
                     const ModelConfig& config);

}  // namespace lte::nn
