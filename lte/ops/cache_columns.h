// What is read from an irradiance cache near a query: the weights of its points, and the columns of
// the means over them.
#pragma once

#include <cstdint>

namespace lte::ops {

/// How much a point j counts for a query near it:
/// w = max(0, n·n_j)⁴ exp(−(near d² + plane h²) / d̄²) + least,
/// where d is the distance from the query, h that from the query's plane, and d̄² the mean of d²
/// over the query's neighbours, or `least_distance2` if that is more.
struct CacheWeights {
  float near, plane, least, least_distance2;
};

/// Channels of irradiance that a point of the cache holds: indirect and direct, three each.
inline constexpr int64_t kCacheLight = 6;
/// Neighbours that a query may have.
inline constexpr int64_t kMostCacheNeighbours = 64;

/// Columns of irradiance_cache_means(). Sums and means are over the neighbours j of a query; g_j is
/// the mean of the first three channels of point j.
struct CacheColumn {
  static constexpr int64_t kLight = 0;     ///< kCacheLight columns: Σ w_j light_j / Σ w_j
  static constexpr int64_t kVariance = 6;  ///< Σ w_j (g_j − g)² / Σ w_j, g of the first 3 columns
  static constexpr int64_t kWeight = 7;      ///< Σ w_j
  static constexpr int64_t kFacing = 8;      ///< plain mean of max(0, n·n_j)
  static constexpr int64_t kHeight = 9;      ///< plain mean of h_j / d̄
  static constexpr int64_t kGrey = 10;       ///< plain mean of g_j
  static constexpr int64_t kDistance2 = 11;  ///< d̄²
};
inline constexpr int64_t kCacheMeans = 12;  ///< columns in all

}  // namespace lte::ops
