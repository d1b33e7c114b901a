// How much a point of an irradiance cache counts for a query near it.
#pragma once

namespace lte::ops {

/// w = max(0, n·n_j)⁴ exp(−(near d² + plane h²) / d̄²) + least: d the distance from the query, h
/// that from the query's plane, d̄² the mean of d² over the query's neighbours, or
/// `least_distance2`.
struct CacheWeights {
  float near, plane, least, least_distance2;
};

}  // namespace lte::ops
