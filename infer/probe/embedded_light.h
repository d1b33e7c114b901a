// Light at points as an embedding says it itself, with direct light beside it and the error to
// expect.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

struct EmbeddedLightOptions {
  bool direct = false;  ///< add direct light, by the rays that lte_probe takes
  bool error = false;   ///< EmbeddedLight::expected_error is wanted
  uint64_t seed = 0;
};

struct EmbeddedLight {
  std::vector<Rgb> irradiance;  ///< W/m²; indirect unless direct light is added
  /// What the embedding and gathered light disagree by at the nearest of some hundred places, and
  /// gi::kSharedError, relative to gi::ErrorUnit; all of the answer where light does not reach.
  /// Empty unless wanted.
  std::vector<double> expected_error;
};

/// @param albedo  of the surfaces at the points
/// @throws lte::Error as SceneEmbedding::decode()
EmbeddedLight embedded_light(const runtime::SceneEmbedding& embedding,
                             const scene::PointTable& points, std::span<const Rgb> albedo,
                             const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const EmbeddedLightOptions& options);

}  // namespace lte::infer
