// Sums of spherical Gaussians a exp(λ (μ · ω − 1)) (Wang et al., All-Frequency Rendering of
// Dynamic, Spatially-Varying Reflectance, 2009), and how well they hold a map of radiance by
// direction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lte/base/enum_names.h"
#include "lte/base/math.h"

namespace lte::experiments {

/// Where the lobes of a map are. Amplitudes are non-negative least squares in both.
enum class GaussianFit {
  Lattice,  ///< on one grid for all maps, with one sharpness: a lobe stores its amplitude
  Greedy,   ///< where the map needs them: a lobe stores axis, sharpness and amplitude
};
constexpr EnumNames<GaussianFit, 2> enum_names(GaussianFit) {
  return {{{GaussianFit::Lattice, "lattice"}, {GaussianFit::Greedy, "greedy"}}};
}

/// Numbers that a lobe of an RGB map stores.
constexpr int numbers_a_lobe(GaussianFit fit) { return fit == GaussianFit::Lattice ? 3 : 6; }

/// A sum of L lobes for each of P maps; all float64.
struct GaussianSums {
  at::Tensor axis;       ///< [P, L, 3] unit
  at::Tensor sharpness;  ///< [P, L] λ, above 0
  at::Tensor amplitude;  ///< [P, L, 3] not negative

  /// @param directions  [cells, 3] float64
  /// @return            [P, cells, 3]
  at::Tensor values(const at::Tensor& directions) const;
};

/// [directions, 3] float64.
at::Tensor direction_table(std::span<const Vec3> directions);

/// Axes on a spherical Fibonacci lattice over the hemisphere (Keinert et al., Spherical Fibonacci
/// Mapping, 2015) and a sharpness that lets neighbours overlap, as lightmaps of such lobes have
/// (Neubelt and Pettineo, Advanced Lighting R&D at Ready At Dawn Studios, 2015).
/// @param directions  [cells, 3] in the frame of the maps: cells of equal projected solid angle
/// @param maps        [P, cells, 3] float64
GaussianSums fit_lattice(int64_t lobes, const at::Tensor& directions, const at::Tensor& maps);

/// Lobe by lobe: that of a dictionary which takes most of what is left, for all channels together,
/// then all amplitudes anew (orthogonal matching pursuit under non-negativity: Bruckstein et al.,
/// On the Uniqueness of Nonnegative Sparse Solutions, 2008). Axes and sharpness then follow the
/// gradient of the squared error, amplitudes at their best (variable projection: Golub and
/// Pereyra, 1973).
/// @param lobes  numbers of lobes, rising
/// @return       the sums of each number in `lobes`
std::vector<GaussianSums> fit_greedily(std::span<const int> lobes, const at::Tensor& directions,
                                       const at::Tensor& maps);

}  // namespace lte::experiments
