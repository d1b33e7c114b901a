// A scene's embedding, from its triangles: scene points, the light on them, the encoder.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lte/embed/culled_lights.h"
#include "lte/embed/point_count.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/memory_limit.h"
#include "lte/runtime/network.h"

namespace lte::embed {

struct EmbedSettings {
  int64_t scene_points = 0;  ///< M; 0 for as many as the scene needs: scene_point_count()
  Reader reader = Reader::Points;
  uint64_t seed = 0;
  bool rescale = false;
  /// Draw scene points only where light reaches them (lte/pathtrace/reach/reach.h); by default as
  /// in the model's training.
  std::optional<bool> prune;
  /// Light groups that bring no light to any query: culled_lights(). Where points are pruned, the
  /// network does not read them.
  std::vector<int> culled_lights;
  runtime::MemoryLimit memory;    ///< of encoding, and of every later picture's decoding
  bool record_attention = false;  ///< keep what the encoder's blocks attend to

  bool prunes(const runtime::Network& network) const {
    return prune.value_or(network.metadata().scene_points_pruned);
  }
};

/// M of such an embedding.
int64_t scene_point_count(const pathtrace::Bvh& bvh, const runtime::Network& network,
                          const EmbedSettings& settings);

/// What EmbedSettings::culled_lights should be for an embedding whose queries are at the receivers:
/// nothing where points are not pruned.
std::vector<int> culled_lights(const pathtrace::Bvh& bvh, const runtime::Network& network,
                               const EmbedSettings& settings, const Receivers& receivers);

struct Embedded {
  runtime::SceneEmbedding embedding;
  pathtrace::PruneCounts pruned;  ///< zeros without pruning
  std::vector<int> culled_lights;
  double sample_s = 0, light_s = 0, encode_s = 0;  ///< wall-clock seconds of the stages
};

/// Samples scene points, estimates the light on them that the network reads, and encodes them.
/// @throws runtime::LimitError for a scene wider than the model knows, unless settings.rescale, and
///         where memory lacks.
Embedded embed(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
               const runtime::Network& network, const EmbedSettings& settings);

}  // namespace lte::embed
