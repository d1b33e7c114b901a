// What `lte_datagen generate` makes: how many scenes, of which generator, and how each is baked.
// Read strictly from YAML.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datagen/bake/bake.h"
#include "datagen/boxes/room.h"
#include "datagen/common/metals.h"
#include "datagen/common/sides.h"
#include "datagen/homes/home.h"
#include "datagen/wild/wild.h"
#include "lte/base/config.h"

namespace lte::datagen {

/// What makes the scenes: a folder of datagen, configured by the section of its name, or all three;
/// or nothing, where they are read from files.
enum class GeneratorKind { Boxes, Homes, Wild, Mixed, Files };

/// "boxes", "homes", "wild", "mixed" or "files".
const char* generator_name(GeneratorKind kind);

/// `mixed:` in the YAML config: shares of scenes, of which at least one is above 0.
struct MixedConfig {
  double boxes = 1, homes = 1, wild = 1;
};

/// `files:` in the YAML config: scenes as scene::find_scenes() finds them, scene i that of file i.
/// They stay as they are: neither `metals` nor `sides`.
struct FilesConfig {
  std::string folder;
};

/// The names match the YAML keys, which base, boxes, homes, wild, mixed and files.yaml of
/// configs/data explain.
struct DatagenConfig {
  int64_t scenes = 1000;
  uint64_t seed = 1;
  double scale = 16;  ///< s, metres: no scene may be larger than this
  double val_share = 0.05, test_share = 0.05;
  /// Splits whose scenes also get views and `path_tracing_64`. Training reads neither.
  std::vector<std::string> evaluation_splits{"train", "val", "test"};
  GeneratorKind generator = GeneratorKind::Boxes;
  /// Keys at the top level, under `views` and under `incident`. Each scene draws a seed of its own.
  BakeOptions bake;
  MetalConfig metals;
  SideConfig sides;
  boxes::RoomConfig boxes;
  homes::HomeConfig homes;
  wild::WildConfig wild;
  MixedConfig mixed;
  FilesConfig files;

  /// Whether some of the scenes are of this generator.
  bool makes(GeneratorKind kind) const;
};

/// Reads every key, checks ranges, and refuses unknown keys. `rooms:`, the former name of `boxes:`,
/// is read too, with a line in the log.
/// @throws lte::Error naming the file and the key.
DatagenConfig read_datagen_config(const Config& yaml);
DatagenConfig load_datagen_config(const std::filesystem::path& path,
                                  const std::vector<std::string>& overrides = {});

/// @throws lte::Error naming the key that is out of range.
void check_datagen_config(const DatagenConfig& config);

/// Writes the whole configuration, defaults included, of the generator that is used. Reading the
/// text gives the same configuration again.
std::string to_yaml(const DatagenConfig& config);

}  // namespace lte::datagen
