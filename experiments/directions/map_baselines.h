// Errors of maps of radiance by direction, and what functions on the sphere make of the very maps
// that a model is compared with.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <ATen/core/Tensor.h>

#include "experiments/directions/spherical_gaussians.h"
#include "experiments/directions/spherical_harmonics.h"
#include "lte/data/incident_field.h"

namespace lte::experiments {

/// Means over scenes. x is π L over the scene's mean emission, y that of the reference.
struct MapErrors {
  double logrel = 0;   ///< mean ((log(x + 1) − log(y + 1)) / (log(y + 1) + kMapEpsilon))²
  double log_mse = 0;  ///< mean (log(x + 1) − log(y + 1))², which the dark does not rule
  double mse = 0;      ///< mean (x − y)²

  /// Adds the errors of maps that count so much.
  void add(const MapErrors& of, double share);
};
inline constexpr double kMapEpsilon = 0.1;

struct HarmonicErrors {
  HarmonicFit fit = HarmonicFit::Projected;
  int degree = 0;
  MapErrors errors;
  double negative = 0;  ///< share of directions whose radiance comes out negative: ringing

  /// Stored for an RGB map.
  int numbers() const { return 3 * (degree + 1) * (degree + 1); }
};

struct GaussianErrors {
  GaussianFit fit = GaussianFit::Lattice;
  int lobes = 0;
  MapErrors errors;

  int numbers() const { return lobes * numbers_a_lobe(fit); }
};

/// Maps at one point beside one another, the reference first; each [cells, 3] float64 of x.
struct MapRow {
  std::string place;
  std::vector<std::pair<std::string, at::Tensor>> maps;
};

/// @param maps, reference  [cells, points, 3] float64 of x
MapErrors errors_of(const at::Tensor& maps, const at::Tensor& reference);

/// That of the first point, of maps [cells, points, 3].
at::Tensor first_of(const at::Tensor& maps);

/// Fits of harmonics of every degree to maps of the cells of one data set.
class HarmonicBaselines {
 public:
  /// @param out  gets a row a fit and degree, in which add_scene() sums
  HarmonicBaselines(const data::IncidentField& field, int highest,
                    std::vector<HarmonicErrors>* out);

  /// @param row  gets the maps at the first point, of the degrees that are shown; null: nobody
  void add_scene(const at::Tensor& reference, double share, MapRow* row);

 private:
  std::vector<HarmonicFitter> fitters_;
  std::vector<HarmonicErrors>* out_;
};

/// The same of spherical Gaussians.
class GaussianBaselines {
 public:
  GaussianBaselines(const data::IncidentField& field, const std::vector<int>& lobes,
                    std::vector<GaussianErrors>* out);
  void add_scene(const at::Tensor& reference, double share, MapRow* row);

 private:
  at::Tensor directions_;
  std::vector<int> lobes_;
  std::vector<GaussianErrors>* out_;
};

}  // namespace lte::experiments
