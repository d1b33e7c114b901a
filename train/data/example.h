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
  RadianceExample radiance;  ///< of models that predict it
  uint64_t seed = 0;         ///< of curve orders and dropout

  Example to(at::Device device) const;
};

/// How the queries of an example are drawn.
struct QueryOptions {
  int64_t count = 0;  ///< distinct, each equally likely; 0: all
  RadianceOptions radiance = {};
};

/// How `config` draws the queries of training.
QueryOptions query_options(const TrainConfig& config);

/// Gathers the points `scene_rows`, ascending, of `scene`, draws its queries, and applies
/// `symmetry`.
Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                     const std::vector<int64_t>& scene_rows, const QueryOptions& queries, Rng* rng);

/// The same with `scene_points` points drawn; 0: all.
inline Example make_example(const TrainingScene& scene, const Symmetry& symmetry,
                            int64_t scene_points, int64_t queries, Rng* rng) {
  const std::vector<int64_t> rows = data::draw_scene_rows(scene.light, scene_points, rng);
  return make_example(scene, symmetry, rows, QueryOptions{queries}, rng);
}

}  // namespace lte::train
