// The directory that the runs of one data set share: what is in it, and who may write what.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datagen/dataset/config.h"
#include "datagen/dataset/manifest.h"
#include "lte/data/dataset.h"

namespace lte::datagen {

/// What has become of all scenes that are planned.
struct FolderState {
  std::vector<int64_t> there, missing;  ///< missing: neither there nor failed
  std::vector<std::string> failed;      ///< "home_00017: what went wrong"
};

/// config.yaml of a data set's directory.
std::filesystem::path config_path(const std::filesystem::path& out);
/// "home_00042", "box_00042", "wild_00042" or, mixed or of a file, "scene_00042". Seeds do not
/// depend on it.
std::string scene_name(GeneratorKind kind, int64_t index);
/// The seed from which scene `index` of a data set is made.
uint64_t scene_seed(uint64_t dataset_seed, int64_t index);

class DatasetFolder {
 public:
  DatasetFolder(const DatagenConfig& config, std::filesystem::path out);

  /// Makes the directory and config.yaml, or checks that those there are of this configuration. A
  /// data set that has scenes named room_00042, as both generators once named theirs, keeps that
  /// name for its new scenes too.
  /// @throws lte::Error naming what is in the way, scenes of the shard without `resume` included.
  void prepare(const Shard& shard, bool resume);

  /// Removes what killed runs left: temporaries of this shard's scenes, which have no other writer,
  /// and temporaries of shared files that are an hour old.
  void remove_leftovers(const Shard& shard) const;

  /// A scene counts if it is the one that would be made. Either a record of its baking and a file
  /// of that size say so, or the file reads without fault and has the right seed and counts.
  /// @param record  what manifests say of it; may be null
  bool is_done(int64_t index, const SceneRecord* record) const;

  FolderState state() const;

  /// Writes dataset.json of what is there.
  /// @return  the number of its scenes
  int64_t write_index(const FolderState& state) const;

  /// Scenes of the whole data set: those of the configuration, or more if an earlier run had more.
  int64_t planned() const { return planned_; }
  data::Split split_of(int64_t index) const;
  /// "home_00042", "box_00042" or, in an older data set, "room_00042".
  std::string name_of(int64_t index) const;
  std::filesystem::path scene_path(int64_t index) const;

 private:
  const DatagenConfig& config_;
  std::filesystem::path out_;
  int64_t planned_;
  bool named_rooms_;  ///< an older data set, whose scenes are room_00042
};

}  // namespace lte::datagen
