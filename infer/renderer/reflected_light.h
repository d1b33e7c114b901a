// What glossy surfaces reflect of bounced light: directions drawn from the material, and the
// radiance from there by the network's radiance decoder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "infer/light/embedding_draws.h"
#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::infer {

struct ReflectedSettings {
  int width = 0, height = 0;
  int directions = 16;  ///< a pixel, from up to four places in it
  uint64_t seed = 0;
};

/// Radiance towards the camera by light that has bounced before, one entry a pixel.
/// @param pixels  y * width + x
/// @throws lte::Error for a model without a radiance decoder, or one that predicts direct light too
std::vector<Rgb> reflected_light(const pathtrace::Bvh& bvh, const EmbeddingDraws& draws,
                                 const scene::Camera& camera, const ReflectedSettings& settings,
                                 std::span<const int64_t> pixels);

}  // namespace lte::infer
