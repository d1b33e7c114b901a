// One training example: scene points, queries and reference drawn from a baked scene under one
// symmetry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/random.h"
#include "lte/data/sample_rows.h"
#include "lte/nn/model.h"
#include "train/data/augment.h"
#include "train/data/radiance_example.h"
#include "train/data/scene_store.h"

namespace lte::train {

struct Example {
  std::string scene;
  nn::PointSet points;
  nn::QuerySet queries;
  at::Tensor target;         ///< [Q, 3] irradiance over the points' emission scalar
  at::Tensor weight;         ///< [Q] of each query in the loss; undefined: all alike
  RadianceExample radiance;  ///< of models that predict it
  uint64_t seed = 0;         ///< of curve orders and dropout

  Example to(at::Device device) const;
};

/// How the queries of an example are drawn and weighed.
struct QueryOptions {
  int64_t count = 0;  ///< 0: all, each once
  /// Variance and Gradient draw with replacement: half of a query's likelihood is that of uniform
  /// drawing, half is in proportion to its score (QueryScores: the square root of noise, or slope).
  /// The inverse of it is the query's weight, at most 2, so that the loss keeps its mean.
  QuerySampling sampling = QuerySampling::Uniform;
  /// λ. A query's weight is divided by 1 + λ n, where n is the variance that its reference's noise
  /// adds to its relative log error; then all are scaled to the mean they had. 0: none of this.
  double noise_weight = 0;
  double epsilon = 0.01;  ///< of the loss
  RadianceOptions radiance = {};
};

/// How `config` draws the queries of training.
QueryOptions query_options(const TrainConfig& config);

/// Gathers the points `scene_rows`, ascending, of `scene`, draws its queries, and applies
/// `symmetry`.
Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                     const std::vector<int64_t>& scene_rows, const QueryOptions& queries, Rng* rng);

/// The same with queries that are all alike, and with `scene_points` points drawn; 0: all.
inline Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                            int64_t scene_points, int64_t queries, Rng* rng) {
  const std::vector<int64_t> rows = data::draw_scene_rows(scene.light, scene_points, rng);
  return make_example(scene, symmetry, rows, QueryOptions{queries}, rng);
}

}  // namespace lte::train
