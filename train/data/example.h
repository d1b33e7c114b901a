// One training example: scene points, queries and reference drawn from a baked scene under one
// symmetry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/random.h"
#include "lte/nn/model.h"
#include "train/data/augment.h"
#include "train/data/scene_store.h"

namespace lte::train {

struct Example {
  std::string scene;
  nn::PointSet points;
  nn::QuerySet queries;
  at::Tensor target;  ///< [Q, 3] irradiance over the points' emission scalar
  at::Tensor weight;  ///< [Q] of each query in the loss; undefined: all alike
  uint64_t seed = 0;  ///< of curve orders and dropout

  Example to(at::Device device) const;
};

/// `count` distinct rows of [0, rows), ascending; all of them if count is 0 or not below rows. Each
/// row is as likely as any other. One comes from each of `count` runs of equal length to within one
/// row (the runs starting at a random row), so tables that are sorted in space are covered evenly.
std::vector<int64_t> draw_rows(int64_t rows, int64_t count, Rng* rng);

/// Scene points kept when a file has more than `count`: as draw_rows() within each light group and
/// within the rest, each class in proportion and with at least one point, so that no luminaire is
/// lost. In ascending order.
std::vector<int64_t> draw_scene_rows(const TrainingScene& scene, int64_t count, Rng* rng);

/// How the queries of an example are drawn and weighed.
struct QueryOptions {
  int64_t count = 0;  ///< 0: all, each once
  /// Other than uniform: with replacement, a query by half as likely as if all were alike and by
  /// half in proportion to its score (QueryScores: square root of noise, or slope), with the
  /// inverse of that as its weight, at most 2. The loss has the mean that uniform drawing gives it.
  QuerySampling sampling = QuerySampling::Uniform;
  /// λ: a query's weight is divided by 1 + λ n, n the variance that its reference's noise adds to
  /// its relative log error; then all are scaled to the mean they had. 0: none of this.
  double noise_weight = 0;
  double epsilon = 0.01;  ///< of the loss
};

/// As `config` has it, for training.
QueryOptions query_options(const TrainConfig& config);

/// @param scene_rows  its scene points, ascending
Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                     const std::vector<int64_t>& scene_rows, const QueryOptions& queries, Rng* rng);

/// The same with queries that are all alike, of `scene_points` points; 0: all.
inline Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                            int64_t scene_points, int64_t queries, Rng* rng) {
  const std::vector<int64_t> rows = draw_scene_rows(scene, scene_points, rng);
  return make_example(scene, symmetry, rows, QueryOptions{queries}, rng);
}

}  // namespace lte::train
