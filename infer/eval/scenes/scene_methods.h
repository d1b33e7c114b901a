// The methods that lte_eval scenes compares: what each is, and its pictures of a scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "infer/eval/scenes/scene_view.h"
#include "infer/renderer/quality.h"
#include "infer/renderer/render_settings.h"
#include "lte/base/stopwatch.h"
#include "lte/image/image.h"
#include "lte/runtime/memory_limit.h"
#include "lte/runtime/network.h"

namespace lte::infer {

/// What answers for indirect light.
enum class SceneMethodKind {
  Network,       ///< rays that read a table of the network's light, and its noise taken away
  Decoded,       ///< the network, at every pixel: as the C interface answers, without rays
  Gather,        ///< rays that read a table of path-traced light, likewise
  Paths,         ///< path tracing
  DenoisedPaths  ///< the same and a denoiser
};

struct SceneModel {
  std::string name;  ///< of its file, without folder and extension
  std::string file;
  runtime::Network network;
};

struct SceneMethod {
  std::string name;  ///< "network lte", "gather-draft", "paths-16"
  SceneMethodKind kind = SceneMethodKind::Paths;
  int paths = 0;                       ///< a pixel, of path tracing
  Quality quality = Quality::Preview;  ///< of rays
  const SceneModel* model = nullptr;
  std::string settings;  ///< for people
};

/// What --methods has by default.
inline constexpr const char* kDefaultSceneMethods =
    "network,network-final,decoded,gather-draft,gather,gather-final,paths-16,paths-16-denoised";

/// Whether words name a method that asks a model.
bool asks_models(const std::vector<std::string>& words);

/// The methods of the words network, network-draft, network-final and decoded (of each model),
/// gather, gather-draft, gather-final, paths-N and paths-N-denoised, in the order of the words,
/// those of a model together.
/// @param models  must outlive the methods
/// @throws lte::Error naming the word that is none
std::vector<SceneMethod> scene_methods(const std::vector<std::string>& words,
                                       const std::vector<SceneModel>& models);

struct ScenePictures {
  image::Image whole;       ///< radiance, [height, width, 3]
  image::Image irradiance;  ///< indirect, at pixel centres
  Seconds seconds;          ///< of the whole picture and of all that comes before it
};

/// Pictures of one scene by one method after another, which share an embedding where they can.
class ScenePainter {
 public:
  struct Settings {
    int width = 0, height = 0, max_depth = 5;
    uint64_t seed = 0;
    runtime::MemoryLimit memory;
  };
  /// @param view  must outlive the painter
  ScenePainter(SceneView* view, const Settings& settings) : view_(*view), settings_(settings) {}

  /// Why a method's pictures would say nothing about it: its model has never seen such light.
  /// Empty where they do.
  std::string not_for(const SceneMethod& method) const;
  /// @throws lte::Error as Renderer::embed()
  ScenePictures paint(const SceneMethod& method);

 private:
  Seconds embed(const SceneModel& model, embed::Reader reader);

  SceneView& view_;
  Settings settings_;
  std::pair<const SceneModel*, int64_t> embedded_{};  ///< and by how many scene points
  Seconds embedding_seconds_;
};

/// A line for each model that sees a scene shrunk, as it is wider than the model knows.
std::vector<std::string> size_notes(const SceneView& view, const std::vector<SceneModel>& models);

}  // namespace lte::infer
