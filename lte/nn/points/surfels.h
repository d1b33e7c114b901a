// Scene points as discs that rays meet (surfels: Pfister et al. 2000; for light: Christensen 2008,
// "Point-Based Approximate Global Illumination"). The radiance decoder starts from what a ray sees
// of them by the light that the points carry: coarse, without a surface or a traced path, and it
// follows metals from disc to disc.
#pragma once

#include <array>
#include <cstdint>

#include "lte/nn/points/point_set.h"
#include "lte/ops/surfel_rays.h"
#include "lte/tensor/tensor.h"

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
  explicit Surfels(const at::Tensor& table) : grid_(ops::make_surfel_grid(table)) {}

  bool defined() const { return grid_.defined(); }
  const at::Tensor& table() const { return grid_.discs; }
  std::array<at::Tensor, 4> tensors() const { return grid_.tensors(); }
  Surfels to(c10::Device device) const { return Surfels(table().to(device)); }

  /// @param position    [Q, 3] network space, on a surface
  /// @param directions  [Q, N, 3] unit
  /// @return            [Q, N, kSeenColumns] on their device and in their dtype; no gradients. Of
  ///                    light that bounced at least once: emission is seen in metal alone
  at::Tensor see(const at::Tensor& position, const at::Tensor& directions) const;

 private:
  ops::SurfelGrid grid_;
};

/// The discs of scene points. Their fronts send out the direct light that they carry and what the
/// irradiance decoder answers there; their backs, the light that they carry.
///
/// @param points    with light and, where anything is metal, gloss
/// @param position  [M, 3] network space
/// @param scale     metres of a unit of network space
/// @param emission_scale  [3]
/// @param irradiance  [M, 3] the decoder's answers on the fronts, over the emission scale
Surfels make_surfels(const PointSet& points, const at::Tensor& position, double scale,
                     const at::Tensor& emission_scale, const at::Tensor& irradiance);

}  // namespace lte::nn
