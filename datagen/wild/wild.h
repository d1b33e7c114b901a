// Rooms of every shape, surface and light, wide instead of pretty: what a network is to meet before
// it meets rooms of other people. datagen/homes makes the lifelike ones, datagen/boxes the plain.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datagen/common/range.h"
#include "datagen/wild/plan.h"
#include "lte/scene/scene.h"

namespace lte::datagen::wild {

/// `wild:` in the YAML config; configs/data/wild.yaml explains the keys. shares.h has what is no
/// key.
struct WildConfig {
  CountRange cells{1, 5};
  Range extent_m{1.5, 15.5};
  CountRange lamps{1, 40};
  double sky_share = 0.3;
  Range detail{0.4, 0.8};
  std::vector<int64_t> texture_sizes{64, 128};
};

inline constexpr double kMinExtent = 0.5;  ///< metres, of any scene

/// How a scene came about, for tests and tables.
struct WildPlan {
  Plan plan;        ///< in its own frame
  Affine to_world;  ///< from there to the scene
  std::vector<LampKind> lamps;
  bool sky = false, closed = false;   ///< closed: no ray from inside leaves
  std::vector<std::string> rejected;  ///< why earlier draws of this seed were not taken
};

struct Wild {
  scene::Scene scene;
  WildPlan plan;
};

/// Makes a scene with one to kMaxGroups light groups of lamps, one more for a sun and a sky each,
/// and a camera in each cell that light reaches. Y is up, units are metres. The same (config, seed)
/// gives the same bytes: a draw that fails a check is followed by the next of the same seed.
/// @throws lte::Error if kMaxDraws of them fail.
Wild generate_wild(const WildConfig& config, uint64_t seed, const std::string& name = "wild");

inline constexpr int kMaxDraws = 30;

}  // namespace lte::datagen::wild
