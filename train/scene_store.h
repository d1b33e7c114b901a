// The scenes of one split, read when first asked for and kept while memory lasts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "lte/base/math.h"
#include "lte/data/dataset.h"

namespace lte::train {
#include "train/query_scores.h"

/// What training needs of a baked scene: no views, and of direct and indirect irradiance what the
/// target is made of.
struct TrainingScene {
  std::string name;
  std::vector<Vec3> position, normal;              ///< [M]
  std::vector<Rgb> albedo, emission;               ///< [M]
  std::vector<float> area;                         ///< [M] m²
  std::vector<int32_t> light;                      ///< [M] light group, −1 for none
  std::vector<Vec3> query_position, query_normal;  ///< [N]
  std::vector<Rgb> query_albedo;                   ///< [N]
  int64_t light_groups = 0;                        ///< G
  std::vector<Rgb> target;                         ///< [G, N] irradiance at unit gain, W/m²
  Bounds bounds;                                   ///< of the scene points

  QueryScores scores;                              ///< [N] each
  int64_t scene_points() const { return static_cast<int64_t>(position.size()); }
  int64_t query_points() const { return static_cast<int64_t>(query_position.size()); }
  size_t size_bytes() const;
};

/// @param target  "indirect" or "total"
/// @throws lte::Error as data::read_scene_sample().
TrainingScene read_training_scene(const std::filesystem::path& path, const std::string& name,
                                  const std::string& target);

/// Least recently used scenes are dropped once `cache_bytes` are exceeded; the latest always stays.
/// One thread at a time.
class SceneStore {
 public:
  SceneStore(std::filesystem::path root, std::vector<data::DatasetEntry> entries,
             std::string target, size_t cache_bytes);

  size_t size() const { return entries_.size(); }
  const std::string& name(size_t index) const { return entries_[index].name; }
  /// @throws lte::Error naming file, tensor and index of what is wrong with it.
  std::shared_ptr<const TrainingScene> get(size_t index);
  size_t cached_bytes() const { return cached_bytes_; }

 private:
  struct Slot {
    std::shared_ptr<const TrainingScene> scene;
    std::list<size_t>::iterator use;
  };
  std::filesystem::path root_;
  std::vector<data::DatasetEntry> entries_;
  std::string target_;
  size_t cache_bytes_, cached_bytes_ = 0;
  std::list<size_t> uses_;  ///< latest first
  std::unordered_map<size_t, Slot> slots_;
};

}  // namespace lte::train
