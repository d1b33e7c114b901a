// The data-set directory: dataset.json and scenes/NAME.safetensors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/check.h"
#include "lte/data/scene_sample.h"

namespace lte::data {

/// Paths behind the light estimates of data generation, and what files that do not say were made
/// with.
inline constexpr int kDefaultLightPaths = 32;
inline constexpr int kDefaultLightDepth = 5;

enum class Split { Train, Val, Test };

/// "train", "val" or "test".
const char* split_name(Split split);
/// @throws lte::Error naming the word.
Split parse_split(const std::string& word);

struct DatasetEntry {
  std::string name;  ///< scenes/<name>.safetensors
  Split split = Split::Train;
  uint64_t seed = 0;
  int64_t scene_points = 0, query_points = 0;
};

/// The content of dataset.json:
/// {"format":"lte-dataset","version":1,"tool":..,"seed":..,"scale":s,"light_paths":..,
/// "light_depth":..,"pruned":..,"planned":..,"scenes":[..]}, and "suns" where there are any.
struct DatasetInfo {
  int version = 1;
  std::string tool_version;
  uint64_t seed = 0;
  /// s, metres: an upper bound on the extent of a scene; network space is (p − b_min)/s.
  double scale = 16.0;
  /// Whether points were drawn only where light can reach them: then inference has to draw its
  /// scene points so too. False for files that do not say.
  bool pruned = false;
  /// Whether some scenes have directional lights: a model trained on others has never seen a sun.
  /// False for files that do not say.
  bool suns = false;
  /// How scene_direct and scene_indirect were estimated: paths a side of each scene point, and the
  /// surface hits of a path. A model trained on them has to be given light made the same way.
  int light_paths = kDefaultLightPaths;
  int light_depth = kDefaultLightDepth;
  /// Scenes that there are to be, at least as many as are listed. The number listed for files that
  /// do not say.
  int64_t planned = 0;
  std::vector<DatasetEntry> scenes;
};

/// Atomic.
void write_dataset_info(const std::filesystem::path& directory, const DatasetInfo& info);

/// Files of a data set are missing that its generator can make. A program that has a command for
/// that names it.
class UnfinishedDataset : public Error {
 public:
  using Error::Error;
};

/// What of a data-set directory belongs to the data set: files, and folders with all in them.
/// config.yaml and manifest are its generator's.
inline const std::vector<std::string> kDatasetParts = {"dataset.json", "config.yaml", "scenes",
                                                       "manifest"};

/// Whether a listed scene whose file is missing is an error, or left for the reader to find out.
enum class MissingScenes { Refuse, Allow };

/// Warns if fewer scenes are listed than planned.
/// @throws lte::Error naming the file and the key if dataset.json is missing, malformed or of a
/// newer version, or names a scene twice; UnfinishedDataset if dataset.json is not written yet or
/// names a scene whose file is missing.
DatasetInfo read_dataset_info(const std::filesystem::path& directory,
                              MissingScenes missing = MissingScenes::Refuse);

std::filesystem::path scene_path(const std::filesystem::path& directory, const std::string& name);

/// The split of a scene from (seed, index) alone, so that shards agree: `val_share` and
/// `test_share` of all, met to within a scene or two by any run of consecutive indices
/// (golden-ratio sequence from a start that `seed` gives).
/// @throws lte::Error if a share is negative or both together exceed 1.
Split assign_split(uint64_t seed, int64_t index, double val_share, double test_share);

/// Entries of one split, in file order.
std::vector<DatasetEntry> entries_of(const DatasetInfo& info, Split split);

}  // namespace lte::data
