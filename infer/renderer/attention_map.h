// What the network looks at, as numbers on a scene's surfaces: for a point, how much each latent
// near it counts in the decoder; for the latent at that point, from where a block of the encoder
// took what it knows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/runtime/attention.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// A point of a surface and the side of it that is asked about.
struct SurfacePoint {
  Vec3 position, normal;
  Rgb albedo;

  /// On the side from which `viewer` sees it.
  SurfacePoint facing(const Vec3& viewer) const;
};

/// The surface nearest to a point, on the side on which it lies, or the front if it lies on the
/// surface; nothing where there is none within `reach`.
std::optional<SurfacePoint> surface_near(const scene::Scene& scene, const Vec3& point, float reach);

/// How far from a surface somebody may point and still mean it: a twentieth of the scene's widest
/// side.
float pointing_reach(const Bounds& bounds);

struct AttentionChoice {
  /// "decoder" for the mean over its layers, "decoder.3" for one of them, or a block of the encoder
  /// as SceneAttention::blocks() names it.
  std::string block = "decoder";
  int64_t head = runtime::SceneAttention::kAllHeads;  ///< of a block of the encoder
};

/// Whether a choice is of the decoder.
bool reads_decoder(const AttentionChoice& choice);

/// The number of an encoder's block.
/// @throws lte::Error as attention_map()
size_t find_block(const runtime::SceneAttention& inside, const std::string& name);

struct AttentionMap {
  /// An entry a latent: multiples of an even share. Of the decoder among the latents that the point
  /// reads, and 0 for the others; of the encoder among all points of the block's resolution.
  std::vector<float> values;
  int64_t latent = 0;  ///< the one at the point: whose attention is shown
  float most = 0;      ///< of the values
};

/// @throws lte::Error of one line for a block or head that the model has not got, naming those that
///         it has
AttentionMap attention_map(const runtime::SceneAttention& inside, const SurfacePoint& point,
                           const AttentionChoice& choice);

}  // namespace lte::infer
