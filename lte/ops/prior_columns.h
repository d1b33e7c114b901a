// The light prior near a query: the weights of the points around it, and the columns of the means
// over them.
#pragma once

#include <cstdint>

namespace lte::ops {

/// How much a point j counts for a query near it:
/// w = max(0, n·n_j)⁴ exp(−(near d² + plane h²) / d̄²) + least,
/// where d is the distance from the query, h that from the query's plane, and d̄² the mean of d²
/// over the query's neighbours, or `least_distance2` if that is more.
struct PriorWeights {
  float near, plane, least, least_distance2;
};

/// What light_prior_features() scales by: s, l and t below.
struct PriorScales {
  double least_mean, log, log_shift;
};

/// Channels of irradiance that each of the two sides of a point holds: indirect and direct, three
/// each. A query reads one side: that whose normal has the larger product with its own, the first
/// where they are equal. Below, n_j and light_j are those of that side. The least weight has the
/// light of both sides: where no point near faces as the query does, what is around is all that is
/// known.
inline constexpr int64_t kPriorLight = 6;
/// Neighbours that a query may have.
inline constexpr int64_t kMaxPriorNeighbours = 64;

/// Columns of light_prior_means(). Sums and means are over the neighbours j of a query; g_j is
/// the mean of the first three channels of point j.
struct PriorColumn {
  static constexpr int64_t kLight =
      0;  ///< kPriorLight columns: Σ w_j light_j / Σ w_j, and `least` times
          ///< the light of the other sides in that sum
  static constexpr int64_t kVariance = 6;  ///< Σ w_j (g_j − g)² / Σ w_j, g of the first 3 columns
  static constexpr int64_t kWeight = 7;      ///< Σ w_j
  static constexpr int64_t kFacing = 8;      ///< plain mean of max(0, n·n_j)
  static constexpr int64_t kHeight = 9;      ///< plain mean of h_j / d̄
  static constexpr int64_t kGray = 10;       ///< plain mean of g_j
  static constexpr int64_t kDistance2 = 11;  ///< d̄²
  /// Only of points that know the relative errors r_j of g_j: Σ (w_j r_j g_j)² / (Σ w_j)², the
  /// variance of g that they make.
  static constexpr int64_t kNoise = 12;
};
inline constexpr int64_t kPriorMeans = 12;  ///< columns of points without errors; one more with

}  // namespace lte::ops
