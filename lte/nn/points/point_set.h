// The network's input: points on the surfaces of a scene, and the query points at which it answers
// irradiance; and the unit of light between the two.
#pragma once

#include <array>
#include <vector>

#include "lte/nn/config.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// Scene points in world space, float32 (or float64 in gradient checks). M >= 1.
struct PointSet {
  at::Tensor position;  ///< [M, 3] metres
  at::Tensor normal;    ///< [M, 3] unit
  at::Tensor albedo;    ///< [M, 3]
  at::Tensor emission;  ///< [M, 3] radiance, W sr^-1 m^-2
  at::Tensor area;      ///< [M] m² each point stands for; weighs the emission scale only
  /// [M, 3] W/m², irradiance on both sides of the surface together, 0 at luminaires: direct, and of
  /// all later bounces. For models that read light; else undefined will do.
  at::Tensor direct, indirect;
  /// [M, 3] the share of these that falls on the side that the normal leaves behind; likewise.
  at::Tensor direct_back, indirect_back;
  /// [M, 2] standard error of indirect irradiance on the front and on the back over its value, of
  /// the mean over the channels, in [0, 1]; for models that read estimates.
  at::Tensor indirect_error;
  /// [M, 2] how metallic and how rough, in [0, 1]; for models that predict radiance. Undefined:
  /// nothing is metal.
  at::Tensor gloss;

  /// All fields, of which some may be undefined.
  std::vector<at::Tensor*> tensors() {
    return {&position, &normal,      &albedo,        &emission,       &area, &direct,
            &indirect, &direct_back, &indirect_back, &indirect_error, &gloss};
  }
  /// The same on a device; what is there already is shared.
  PointSet to(c10::Device device) const;
};

/// Query points in world space.
struct QuerySet {
  at::Tensor position;  ///< [Q, 3] metres
  at::Tensor normal;    ///< [Q, 3] unit, towards the side in question
  at::Tensor albedo;    ///< [Q, 3]

  /// The same on a device; what is there already is shared.
  QuerySet to(c10::Device device) const;
};

/// @throws c10::Error naming the first row that is not finite or out of range (docs/model.md), or
///         the input of a model of `config` that is missing
void check_points(const PointSet& points, const ModelConfig& config);
/// The same of all but the light on them.
void check_surfaces(const PointSet& points);
void check_queries(const QuerySet& queries);
/// @param directions  [Q, N, 3], N of each query
/// @throws c10::Error naming the first query and direction that is not unit, or points into the
///         surface
void check_directions(const QuerySet& queries, const at::Tensor& directions);

/// The same points by position along x, then y, then z, then by whatever else there is of them: one
/// order for all orders in which a caller may have them. What an encoder makes of points hangs on
/// their order, as farthest point sampling starts with the first.
PointSet in_canonical_order(const PointSet& points);

/// Area-weighted mean emission by color channel, [3] float64 on the CPU; 0 for a channel without
/// emission. The network reads emission divided by it, and answers irradiance divided by it: no
/// surface moves light from one channel to another, so each channel of irradiance is linear in the
/// same channel of emission.
at::Tensor emission_scale(const PointSet& points);

/// The mean of emission_scale() over the channels; 1 for a scene without emission.
double mean_emission(const PointSet& points);

/// What irradiance is multiplied by to become the target of training: 1 / emission_scale(), and 0
/// for a channel without emission, which has no irradiance either.
std::array<double, 3> target_factors(const at::Tensor& emission_scale);

}  // namespace lte::nn
