// Scene points as discs that rays meet (surfels: Pfister et al. 2000; for light: Christensen 2008,
// "Point-Based Approximate Global Illumination"). What a ray sees of them, by the light that the
// points are told of, is what the radiance decoder starts from: coarse, without a surface or a
// traced path, and it follows metals from disc to disc.
#pragma once

#include <cstdint>
#include <memory>

#include <ATen/core/Tensor.h>

#include "lte/base/math.h"
#include "lte/nn/point_set.h"

namespace lte::nn {

/// Columns of what a ray sees: π radiance over the emission scale by channel, log(1 + it), whether
/// it meets a disc, the logarithm of the distance, the share of metal, and the cosine at the disc.
enum SeenColumn : int64_t {
  kSeenRadiance = 0,
  kSeenLog = 3,
  kSeenHit = 6,
  kSeenDistance = 7,
  kSeenMetal = 8,
  kSeenCosine = 9
};
inline constexpr int64_t kSeenColumns = 10;
/// Of these, what the network reads: all but the radiance itself.
inline constexpr int64_t kSeenFeatures = kSeenColumns - kSeenLog;

class SurfelGrid;

/// The discs of a scene. A copy shares the grid.
class Surfels {
 public:
  /// Columns of table().
  enum Column : int64_t {
    kPosition = 0,
    kNormal = 3,
    kRadius = 6,
    kFront = 7,  ///< π times what the side of the normal sends out, over the emission scale
    kBack = 10,
    kEmission = 13,  ///< the same of what it emits
    kMetal = 16,     ///< reflectance of the metal at normal incidence, by channel
    kMetallic = 19,
    kRoughness = 20
  };
  static constexpr int64_t kColumns = 21;

  Surfels() = default;
  /// @param table  [M, kColumns] float32 on the CPU
  /// @param total  whether rays see emission too, not only what bounced
  Surfels(const at::Tensor& table, bool total);

  bool defined() const { return table_.defined(); }
  const at::Tensor& table() const { return table_; }

  /// @param position    [Q, 3] network space, on a surface
  /// @param directions  [Q, N, 3] unit
  /// @return            [Q, N, kSeenColumns] on their device and in their dtype; no gradients
  at::Tensor see(const at::Tensor& position, const at::Tensor& directions) const;

 private:
  at::Tensor table_;
  std::shared_ptr<const SurfelGrid> grid_;
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
