// The checkpoints of a run directory: the last ones, the best one, and which of them to go on from.
//
// checkpoint.safetensors is the newest. Those before it are checkpoint_STEP.safetensors, and the
// one with the lowest validation loss is checkpoint_best.safetensors. No file names another, so the
// directory may be moved. A kill at any moment leaves the files in one of the states that
// newest_whole() understands.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <vector>

namespace lte::train {

std::filesystem::path best_checkpoint_path(const std::filesystem::path& run);

class CheckpointFiles {
 public:
  /// @param keep  how many of the last checkpoints stay, at least 1; the best one stays beside them
  CheckpointFiles(std::filesystem::path run, int64_t keep) : run_(std::move(run)), keep_(keep) {}

  /// Whether there is any, whole or not.
  bool any() const { return !list().empty(); }

  /// The whole one of the latest step. With `warn`, a warning says which newer ones are damaged,
  /// and how.
  /// @throws lte::Error if there is none, with what is wrong with each; or if one is of a newer
  /// format
  std::filesystem::path newest_whole(bool warn);

  /// A whole one of `step`, if there is one.
  std::optional<std::filesystem::path> whole_of_step(int64_t step) const;

  /// Lets `write` make the checkpoint of `step` under the name that it is given, and makes that
  /// file the newest. Then it removes the oldest beyond `keep`, those of later steps that an
  /// earlier session left, and those that newest_whole() found damaged.
  /// @throws lte::Error as `write` does: all files are as they were
  void add(int64_t step, const std::function<void(const std::filesystem::path&)>& write);

  /// Makes the newest one the best one as well. Both share their blocks on a disk that has links.
  void keep_newest_as_best() const;

 private:
  struct Entry {
    std::filesystem::path path;
    int64_t step;
  };
  std::vector<Entry> list() const;
  std::filesystem::path path_of(int64_t step) const;
  void prune(int64_t newest_step) const;

  std::filesystem::path run_;
  int64_t keep_;
  std::set<std::filesystem::path> damaged_;
};

/// Removes the temporary files that killed processes have left in `run`. Only the process that
/// holds the run's lock may call it.
void remove_leftovers(const std::filesystem::path& run);

}  // namespace lte::train
