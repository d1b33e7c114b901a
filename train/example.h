// One training example: scene points, queries and reference drawn from a baked scene under one
// symmetry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/base/random.h"
#include "lte/nn/model.h"
#include "train/augment.h"
#include "train/scene_store.h"

namespace lte::train {

struct Example {
  std::string scene;
  nn::PointSet points;
  nn::QuerySet queries;
  at::Tensor target;  ///< [Q, 3] irradiance over the points' emission scalar
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

/// @param scene_points, queries  how many to draw; 0: all
Example make_example(const TrainingScene& scene, const Symmetry& symmetry, int64_t scene_points,
                     int64_t queries, Rng* rng);

}  // namespace lte::train
