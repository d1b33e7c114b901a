// What a bake has sampled so far, kept in its folder: --resume goes on there, and shards that
// processes have baked are joined.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "infer/renderer/made_with.h"
#include "lte/bake/light.h"
#include "lte/base/safetensors.h"

namespace lte::infer {

/// The files of a bake's parts, one a shard and layer.
class BakeParts {
 public:
  /// @param folder  of --out
  BakeParts(std::filesystem::path folder, MadeWith made_with)
      : folder_(std::move(folder)), made_with_(std::move(made_with)) {}

  /// Of how many shards the folder has parts; 0 without any.
  /// @throws lte::Error where they are of several counts
  int shards() const;
  /// @throws lte::Error naming the file where it is damaged or was made with other settings
  std::optional<bake::LightState> read(bake::Shard shard, size_t layer, size_t texels,
                                       size_t charts, bool direct) const;
  /// Whole or not at all.
  void write(bake::Shard shard, size_t layer, const bake::LightState& state) const;
  /// Of all layers of so many shards.
  void remove(int shards) const;

 private:
  std::filesystem::path name(bake::Shard shard, size_t layer) const;

  std::filesystem::path folder_;
  MadeWith made_with_;
};

/// Sides and passes of a state.
using StateCounts = std::array<int64_t, 5>;
/// The tensors of a state, by their names in files. State and counts must outlive the writer.
/// @param counts  gets what the writer borrows
void add_state(const bake::LightState& state, StateCounts* counts, SafetensorsWriter* writer);
/// @throws lte::Error naming file and tensor
bake::LightState read_state(const SafetensorsFile& file, size_t texels, size_t charts, bool direct);

/// Reads "2/4". @throws lte::Error naming --shard
bake::Shard parse_shard(const std::string& text);

}  // namespace lte::infer
