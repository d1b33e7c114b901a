// The scenes of one split, read when first asked for and kept while memory lasts.
#pragma once

#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <list>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "lte/base/half.h"
#include "lte/base/math.h"
#include "lte/data/dataset.h"
#include "lte/data/incident_field.h"
#include "lte/nn/config.h"

namespace lte::train {

/// The part of a baked scene that training needs: not the views, nor direct irradiance at queries.
struct TrainingScene {
  std::string name;
  std::vector<Vec3> position, normal;              ///< [M]
  std::vector<Rgb> albedo, emission;               ///< [M]
  std::vector<float> area;                         ///< [M] m²
  std::vector<int32_t> light;                      ///< [M] light group, −1 for none
  std::vector<Rgb> direct, indirect;               ///< [G, M] at unit gain; may be empty
  std::vector<Rgb> direct_back, indirect_back;     ///< [G, M], of these; may be empty
  std::vector<Half> error, error_back;             ///< [G, M], of indirect light; may be empty
  std::vector<float> metallic, roughness;          ///< [M]; both empty where nothing is metal
  std::vector<Vec3> query_position, query_normal;  ///< [N]
  std::vector<Rgb> query_albedo;                   ///< [N]
  int64_t light_groups = 0;                        ///< G
  std::vector<Rgb> target;       ///< [G, N] indirect irradiance at unit gain, W/m²
  data::IncidentField incident;  ///< for models that predict radiance; without `direct`
  Bounds bounds;                 ///< of the scene points

  int64_t scene_points() const { return static_cast<int64_t>(position.size()); }
  int64_t query_points() const { return static_cast<int64_t>(query_position.size()); }
  size_t size_bytes() const;
};

/// The light on scene points that a model reads, and whether it predicts radiance: keys of its
/// configuration.
struct LightKeys {
  nn::LightInput input = nn::LightInput::Emission;
  bool radiance = false;

  LightKeys() = default;
  LightKeys(nn::LightInput light_input) : input(light_input) {}  // NOLINT(*explicit*)
  explicit LightKeys(const nn::ModelConfig& model)
      : input(model.light_input), radiance(model.predicts_radiance()) {}
};

/// @param light   the model's: what else is kept
/// @param solved  folder of solved_light()
/// @throws lte::Error as data::read_scene_sample(), or if the file lacks input of the model.
TrainingScene read_training_scene(const std::filesystem::path& path, const std::string& name,
                                  const LightKeys& light = {},
                                  const std::filesystem::path& solved = {});

struct SceneStoreOptions {
  size_t cache_bytes = 0;   ///< memory for scenes that are not in use
  double scale = INFINITY;  ///< s, metres: a scene must fit into a cube of this side
  bool skip_bad = false;    ///< go on without scenes that cannot be used
  LightKeys light = {};
  std::filesystem::path solved = {};  ///< folder of solved_light(); empty: solutions are not kept
};

/// Reads scenes and keeps them. The least recently used ones are dropped once `cache_bytes` are
/// exceeded; the latest always stays. For one thread at a time.
class SceneStore {
 public:
  SceneStore(std::filesystem::path root, std::vector<data::DatasetEntry> entries,
             SceneStoreOptions options);

  size_t size() const { return entries_.size(); }
  const std::string& name(size_t index) const { return entries_[index].name; }
  /// A scene is bad if its file is missing, damaged or of another version, holds a value out of
  /// range, or exceeds the scale. With `skip_bad` it is named in a warning the first time.
  /// @return null for a bad scene if those are skipped
  /// @throws lte::Error naming file, tensor and index of what is wrong with a scene; if bad scenes
  /// are skipped, only when none is left
  std::shared_ptr<const TrainingScene> get(size_t index);
  /// The same of several scenes: what is not kept is read, and its light solved, beside each other.
  std::vector<std::shared_ptr<const TrainingScene>> get(std::span<const size_t> indices);
  /// Indices of the scenes skipped so far.
  const std::set<size_t>& bad() const { return bad_; }
  size_t cached_bytes() const { return cached_bytes_; }

 private:
  std::shared_ptr<const TrainingScene> read(size_t index) const;
  /// @param scene, error  what read() gave
  std::shared_ptr<const TrainingScene> keep(size_t index,
                                            std::shared_ptr<const TrainingScene> scene,
                                            const std::exception_ptr& error);

  struct Slot {
    std::shared_ptr<const TrainingScene> scene;
    std::list<size_t>::iterator use;
  };
  std::filesystem::path root_;
  std::vector<data::DatasetEntry> entries_;
  SceneStoreOptions options_;
  size_t cached_bytes_ = 0;
  std::set<size_t> bad_;
  std::list<size_t> uses_;  ///< latest first
  std::unordered_map<size_t, Slot> slots_;
};

}  // namespace lte::train
