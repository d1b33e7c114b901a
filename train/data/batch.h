// Which scenes, points, queries and symmetries each step trains on: a function of (seed, step)
// alone, so that a resumed run goes on with the very examples it would have had.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <vector>

#include "train/config.h"
#include "train/data/example.h"
#include "train/data/scene_store.h"
#include "train/distributed/rank.h"

namespace lte::train {

/// An endless sequence of scenes: one epoch after another, each a fresh permutation of all of them.
class EpochOrder {
 public:
  EpochOrder(uint64_t seed, size_t scenes) : seed_(seed), scenes_(scenes) {}
  /// @return index of the scene at `position`
  size_t scene_at(uint64_t position);

 private:
  uint64_t seed_;
  size_t scenes_;
  uint64_t epoch_ = UINT64_MAX;
  std::vector<size_t> order_;
};

/// Makes this process's examples of a step: of its scenes every `rank.count`-th, beginning with
/// scene `rank.index`, so that all processes together have the examples that one alone would have.
/// Another thread makes those of the next step, and no more, while the model works: memory holds
/// the examples of two steps.
///
/// In the place of a scene that the store skips comes another, drawn by its position in the order
/// alone: the same one whichever process asks, however often the run is stopped.
class BatchLoader {
 public:
  /// @param scale    s, metres: a rotated scene must fit into a cube of this side
  /// @param threads  that share the making of a step's examples; more than one where a GPU leaves
  ///                 the processor idle
  BatchLoader(const TrainConfig& config, double scale, SceneStore* store, const Rank& rank = {},
              int threads = 1);
  ~BatchLoader();
  BatchLoader(const BatchLoader&) = delete;
  BatchLoader& operator=(const BatchLoader&) = delete;

  /// Returns the examples of `step`, and starts on those of step + 1.
  std::vector<Example> take(int64_t step);
  /// Seconds that take() has waited for examples, over all calls.
  double waited_seconds() const { return waited_seconds_; }

 private:
  std::vector<std::shared_ptr<const TrainingScene>> scenes_at(
      const std::vector<uint64_t>& positions);
  std::vector<int64_t> scene_rows(const TrainingScene& scene, Rng* rng) const;
  Example make_one(uint64_t position, const TrainingScene& scene) const;
  std::vector<Example> make(int64_t step);

  TrainConfig config_;
  double scale_;
  SceneStore* store_;
  Rank rank_;
  int threads_;
  EpochOrder order_;
  std::future<std::vector<Example>> next_;
  int64_t next_step_ = -1;
  double waited_seconds_ = 0;
};

/// The fixed examples of the validation split: no augmentation, the same points and queries every
/// time.
std::vector<Example> validation_examples(const TrainConfig& config, SceneStore* store);

/// Mean of the normalized target over at most 64 scenes, spread evenly over `store`. It is what an
/// untrained network answers.
double mean_target(const TrainConfig& config, SceneStore* store);

}  // namespace lte::train
