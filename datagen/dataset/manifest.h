// What a run of `lte_datagen generate` records beside the data: one line of JSON when it starts,
// one for each scene and one when it ends, in a file of its own for each shard. Times and hosts are
// kept here, so that the data set is the same bytes whoever made it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "lte/base/locked_file.h"

namespace lte::datagen {

/// A share of a data set: its scenes i with i % count == index.
struct Shard {
  int64_t index = 0, count = 1;
  bool holds(int64_t scene) const { return scene % count == index; }
};

/// @throws lte::Error unless 0 <= index < count
void check_shard(const Shard& shard);

/// How the making of one scene went.
struct SceneRecord {
  int64_t index = 0;
  std::string name, split;
  uint64_t seed = 0;
  std::string error;                               ///< empty if it was baked
  double generate_s = 0, bake_s = 0, seconds = 0;  ///< of geometry, of ground truth, of all
  int64_t rays = 0;                                ///< paths started, whatever for
  int64_t triangles = 0;                           ///< of all instances
  int64_t bytes = 0;                               ///< of the scene file
  std::string source;                              ///< the file it was read from; else empty
};

/// What all runs say about each scene, by index: its baking if any run baked it, else its last
/// failure.
using SceneRecords = std::map<int64_t, SceneRecord>;

/// `out`/manifest
std::filesystem::path manifest_folder(const std::filesystem::path& out);

/// Reads every manifest of the data set in `out`. A line that a kill cut short is skipped.
SceneRecords read_manifests(const std::filesystem::path& out);

/// `out`/manifest/shard_I_of_N.jsonl, held by one process as long as the object lives.
class Manifest {
 public:
  /// Makes the folder and the file if they are missing.
  /// @throws lte::Error if another process is at work on this shard, or on a shard of another
  ///         count, or the file cannot be written. A file system without locks only gets a warning.
  Manifest(const std::filesystem::path& out, const Shard& shard);

  /// @param config  the whole configuration as YAML
  void begin(uint64_t seed, const std::string& config);
  void add(const SceneRecord& record);
  void end(int64_t baked, int64_t kept, int64_t failed, double seconds);

 private:
  void refuse_other_cuts() const;
  void append(const std::string& line);

  std::filesystem::path folder_, path_;
  Shard shard_;
  LockedFile file_;
};

}  // namespace lte::datagen
