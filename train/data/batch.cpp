#include "train/data/batch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <ATen/ops/mean.h>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/data/sample_rows.h"

namespace lte::train {
namespace {

// Streams of random numbers that must not meet.
constexpr uint64_t kOrderStream = 1, kExampleStream = 2, kValidationStream = 3, kMeanStream = 4,
                   kReplacementStream = 5;

/// Points and directions of each that are validated.
constexpr int64_t kValidationRadiancePoints = 64, kValidationDirections = 256;

}  // namespace

size_t EpochOrder::scene_at(uint64_t position) {
  const uint64_t epoch = position / scenes_;
  if (epoch != epoch_) {
    epoch_ = epoch;
    order_.resize(scenes_);
    std::iota(order_.begin(), order_.end(), size_t{0});
    Rng rng(seed_, hash_combine(kOrderStream, epoch));
    for (size_t i = scenes_ - 1; i > 0; --i) std::swap(order_[i], order_[rng.below(i + 1)]);
  }
  return order_[position % scenes_];
}

BatchLoader::BatchLoader(const TrainConfig& config, double scale, SceneStore* store,
                         const Rank& rank, int threads)
    : config_(config),
      scale_(scale),
      store_(store),
      rank_(rank),
      threads_(threads),
      order_(config.seed, store->size()) {}

BatchLoader::~BatchLoader() {
  if (next_.valid()) next_.wait();
}

std::vector<std::shared_ptr<const TrainingScene>> BatchLoader::scenes_at(
    const std::vector<uint64_t>& positions) {
  std::vector<size_t> indices;
  for (const uint64_t position : positions) indices.push_back(order_.scene_at(position));
  std::vector<std::shared_ptr<const TrainingScene>> scenes = store_->get(indices);
  // A scene that is skipped gives way to one that the position alone decides. The store throws when
  // none is left, so this ends.
  for (size_t i = 0; i < scenes.size(); ++i) {
    for (Rng rng(config_.seed, hash_combine(kReplacementStream, positions[i])); !scenes[i];)
      scenes[i] = store_->get(rng.below(store_->size()));
  }
  return scenes;
}

std::vector<int64_t> BatchLoader::scene_rows(const TrainingScene& scene, Rng* rng) const {
  int64_t count = config_.data.scene_points;
  if (config_.augment.point_dropout > 1) {
    const int64_t most = count == 0 ? scene.scene_points() : std::min(count, scene.scene_points());
    const double divisor = std::pow(config_.augment.point_dropout, rng->uniform());
    count = std::max<int64_t>(1, std::llround(static_cast<double>(most) / divisor));
  }
  return data::draw_scene_rows(scene.light, count, rng);
}

Example BatchLoader::make_one(uint64_t position, const TrainingScene& scene) const {
  Rng rng(config_.seed, hash_combine(kExampleStream, position));
  const Symmetry symmetry =
      draw_symmetry(config_.augment, scene.light_groups, scene.bounds, scale_, &rng);
  return make_example(scene, symmetry, scene_rows(scene, &rng), query_options(config_), &rng);
}

std::vector<Example> BatchLoader::make(int64_t step) {
  std::vector<uint64_t> positions;
  const int64_t count = config_.train.scenes_per_step;
  for (int64_t slot = rank_.index; slot < count; slot += rank_.count)
    positions.push_back(static_cast<uint64_t>(step * count + slot));
  const std::vector<std::shared_ptr<const TrainingScene>> scenes = scenes_at(positions);
  std::vector<Example> examples(scenes.size());
  const auto make_every = [&](size_t first, size_t stride) {
    for (size_t i = first; i < scenes.size(); i += stride)
      examples[i] = make_one(positions[i], *scenes[i]);
  };
  const size_t threads = std::min(static_cast<size_t>(threads_), scenes.size());
  std::vector<std::future<void>> others;
  for (size_t i = 1; i < threads; ++i)
    others.push_back(std::async(std::launch::async, make_every, i, threads));
  make_every(0, threads);
  for (std::future<void>& other : others) other.get();
  return examples;
}

std::vector<Example> BatchLoader::take(int64_t step) {
  const Timer timer;
  std::vector<Example> examples;
  if (next_.valid()) {
    std::vector<Example> made = next_.get();
    if (next_step_ == step) examples = std::move(made);
  }
  if (examples.empty()) examples = make(step);
  waited_seconds_ += timer.seconds();
  next_step_ = step + 1;
  if (next_step_ < config_.train.steps) {
    next_ = std::async(std::launch::async, [this, step] { return make(step + 1); });
  }
  return examples;
}

std::vector<Example> validation_examples(const TrainConfig& config, SceneStore* store) {
  const size_t wanted = static_cast<size_t>(config.train.validation_scenes);
  const size_t count = wanted == 0 ? store->size() : std::min(wanted, store->size());
  std::vector<Example> examples;
  for (size_t i = 0; i < count; ++i) {
    const auto scene = store->get(i);
    if (!scene) continue;
    Rng rng(kValidationStream, i);  // not the run's seed: runs are compared on the same queries
    const std::vector<int64_t> rows =
        data::draw_scene_rows(scene->light, config.data.scene_points, &rng);
    QueryOptions queries{config.train.validation_queries};
    queries.radiance = {kValidationRadiancePoints, kValidationDirections};
    examples.push_back(
        make_example(*scene, identity_symmetry(scene->light_groups), rows, queries, &rng));
  }
  return examples;
}

double mean_target(const TrainConfig& config, SceneStore* store) {
  constexpr size_t kScenes = 64;
  const size_t count = std::min(kScenes, store->size());
  double sum = 0;
  int used = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto scene = store->get(i * store->size() / count);
    if (!scene) continue;
    ++used;
    Rng rng(config.seed, hash_combine(kMeanStream, i));
    sum += make_example(*scene, identity_symmetry(scene->light_groups), config.data.scene_points,
                        config.data.queries_per_scene, &rng)
               .target.mean()
               .item<double>();
  }
  LTE_CHECK(used > 0, "none of ", count, " scenes spread over the training split can be used");
  return sum / used;
}

}  // namespace lte::train
