// What `lte_datagen generate` makes: number and kind of rooms, and how each is baked. Read strictly
// from YAML.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datagen/bake/bake.h"
#include "datagen/boxes/room.h"
#include "datagen/homes/home.h"
#include "lte/base/config.h"

namespace lte::datagen {

/// The names match the YAML keys; configs/data/rooms.yaml and boxes.yaml explain them.
struct DatagenConfig {
  int64_t scenes = 1000;
  uint64_t seed = 1;
  double scale = 16;  ///< s, metres: no scene may be larger
  double val_share = 0.05, test_share = 0.05;
  /// Splits whose scenes also get views and the rival (`path_tracing_64`); training itself reads
  /// neither.
  std::vector<std::string> evaluation_splits{"train", "val", "test"};
  /// What makes the scenes: `boxes` (configured by `rooms`) or `homes`.
  std::string generator = "boxes";
  BakeOptions bake;  ///< keys at the top level and under `views`; its seed is drawn scene by scene
  RoomConfig rooms;
  homes::HomeConfig homes;
};

/// Reads every key, checks ranges, and refuses unknown keys.
/// @throws lte::Error naming the file and the key.
DatagenConfig read_datagen_config(const Config& yaml);
DatagenConfig load_datagen_config(const std::filesystem::path& path,
                                  const std::vector<std::string>& overrides = {});

/// @throws lte::Error naming the key that is out of range.
void check_datagen_config(const DatagenConfig& config);

/// The whole configuration, defaults included, of the generator that is used; reading it gives the
/// same again. `boxes` is not named, so older data sets keep their config.yaml.
std::string to_yaml(const DatagenConfig& config);

}  // namespace lte::datagen
