// A data set of procedural scenes: generated, baked and listed, in shards if wanted, and
// resumed after a stop.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "datagen/dataset/config.h"
#include "datagen/dataset/dataset_folder.h"
#include "lte/cli/scene_flags.h"

namespace lte::datagen {

struct GenerateOptions {
  std::filesystem::path out;
  Shard shard;          ///< what this run bakes
  bool resume = false;  ///< keep the valid scenes that are there
  bool strict = false;  ///< end at the first scene that fails
  bool glb = false;     ///< also write scenes/NAME.glb
  SceneFlags loading;   ///< of scene files
};

struct GenerateResult {
  int64_t baked = 0, kept = 0, failed = 0;  ///< by this run
  int64_t planned = 0;                      ///< scenes of the whole data set
  int64_t missing = 0;                      ///< of those, neither there nor failed
  int64_t listed = 0;                       ///< scenes in dataset.json; 0 if this run wrote none
  double seconds = 0;
  std::string first_error;  ///< "home_00017: what went wrong"
};

/// Makes one scene of a data set: `index`, `name`.
using SceneMaker = std::function<scene::Scene(int64_t, const std::string&)>;

/// Makes config.yaml, manifest/, scenes/ and, when every scene of the whole data set is there or
/// has failed, dataset.json. A configuration gives the same bytes, but for the manifests, whatever
/// the number of threads, shards and interruptions. Shards of one count may share `out` at the same
/// time, on several machines: no file but dataset.json and config.yaml has two writers, and those
/// two have the same content whoever writes them last. Each file appears whole or not at all, so a
/// run that is killed loses the scene in work and nothing else.
///
/// A scene that fails is recorded in the manifest and left out. kFailuresInARow failures in a row
/// end the run, since then something other than the scenes is at fault. So does a full disk, at
/// once.
/// @param make_scene  for scenes of other sources; empty for those of the configuration
/// @throws lte::Error if `out` is not empty and not a data set of this configuration, or holds
///         scenes of this shard and `resume` is not set, another process is at work on them, a
///         file cannot be written, or there are fewer files than scenes that are to be read.
GenerateResult generate_dataset(const DatagenConfig& config, const GenerateOptions& options,
                                const SceneMaker& make_scene = {});

inline constexpr int kFailuresInARow = 5;

/// Writes dataset.json of the scenes that are there, whether all are or not, and bakes nothing.
/// @throws lte::Error if `out` is no data set of generate_dataset().
GenerateResult merge_dataset(const std::filesystem::path& out);

/// The generator of a seed's scene: the configured one, or of mixed ones that which the seed draws.
GeneratorKind generator_of(const DatagenConfig& config, uint64_t seed);

/// Makes the scene of a seed with that generator, which is none of files.
scene::Scene generate_scene(const DatagenConfig& config, uint64_t seed, const std::string& name);

/// Scene `index` of a data set of this configuration, as generate_dataset() makes it.
scene::Scene make_scene(const DatagenConfig& config, int64_t index);

/// How generate_dataset() bakes that scene: with views only where its split has them.
BakeOptions bake_options(const DatagenConfig& config, int64_t index, const scene::Scene& scene);

}  // namespace lte::datagen
