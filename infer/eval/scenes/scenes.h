// lte_eval scenes: pictures of anybody's scenes by several methods against path tracing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "infer/eval/measure/pair_error.h"
#include "infer/eval/scenes/scene_methods.h"
#include "lte/cli/scene_flags.h"
#include "lte/scene/find_scenes.h"

namespace lte::infer {

struct ScenesOptions {
  int width = 192, height = 144;
  int reference_paths = 128;  ///< a pixel, of each of both references
  int max_depth = 5;          ///< surface hits after the primary one: as the models were trained
  uint64_t seed = 0;          ///< of every method; the references have others
  SceneFlags loading;
  runtime::MemoryLimit memory;
  std::filesystem::path report;      ///< folder of pictures and kept results; empty: none
  std::filesystem::path references;  ///< folder of kept references; empty: none
  bool resume = false;               ///< take kept results of the report folder
};

/// A method's figures in a scene.
struct MethodFigures {
  PairError irradiance, whole;
  double flip = 0, ssim = 0;  ///< of the tone-mapped whole picture against the references' mean
  Seconds seconds;
};

struct MethodOutcome {
  std::string not_measured;  ///< why; empty if it was
  MethodFigures figures;
  std::string png;  ///< the bytes of its picture; empty without a report
};

struct SceneOutcome {
  std::string name, error;          ///< why it was refused; empty if it was measured
  std::string camera, camera_from;  ///< JSON; which camera it is
  int64_t triangles = 0;
  std::vector<std::string> notes;
  std::vector<MethodOutcome> methods;  ///< in the order of the run's; empty if refused
  std::string png;                     ///< of the reference
};

struct ScenesResult {
  std::vector<SceneMethod> methods;
  std::vector<SceneOutcome> scenes;  ///< in the order of their names
  int parts = 0;                     ///< files that were left out as parts of other scenes
};

/// A method over all scenes in which its irradiance could be measured.
struct MethodSummary {
  int right = 0, of = 0;
  double worth_mean = 0;  ///< geometric
  double worth_median = 0, worth_least = 0;
  Seconds seconds;  ///< medians
};
MethodSummary summary_of(const ScenesResult& result, size_t method);

/// Measures every scene by every method. What fails in one scene is its error, and the others go
/// on.
/// @throws lte::Error for a camera file that cannot be its scene's, ReferenceFault for kept
///         references, and what was said about the first scene if none could be measured
ScenesResult evaluate_scenes(const scene::FoundScenes& files, const std::vector<SceneModel>& models,
                             const std::vector<std::string>& method_words,
                             const ScenesOptions& options);

/// For the terminal: a line a method, then a line a scene.
std::string scenes_table(const ScenesResult& result);

std::string scenes_json(const ScenesResult& result, const ScenesOptions& options);

/// A self-contained page, the scene in which the first method is worst first.
std::string scenes_html(const ScenesResult& result, const ScenesOptions& options);

/// Indices of scenes for people: measured ones by the first method's error in blocks, largest
/// first, then those of which nothing could be measured.
std::vector<size_t> worst_first(const ScenesResult& result);

}  // namespace lte::infer
