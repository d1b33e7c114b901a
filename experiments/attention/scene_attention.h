// Looking inside an embedding: which latents a query reads and how much each counts, and from where
// on the scene's surfaces each block of the encoder took what a latent knows.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/runtime/embedding.h"

namespace lte::experiments {

/// A block of the encoder.
struct AttentionBlock {
  std::string name;  ///< stage and block, as in the names of parameters: "down3.2"
  int64_t heads = 1;
  int64_t points = 0;  ///< that it attends over: those of its resolution, each some latents
};

/// How much the latents near a query count in its answer. Shares add up to one.
struct LatentsRead {
  std::vector<int64_t> latent;               ///< nearest first
  std::vector<float> share;                  ///< of each, the mean over the decoder's layers
  std::vector<std::vector<float>> by_layer;  ///< the same of each layer
};

/// Reads a recorded embedding, which it holds. Any number of threads may ask at the same time.
class SceneAttention {
 public:
  /// @throws lte::Error for an embedding made without runtime::EncodeOptions::record_attention
  explicit SceneAttention(std::shared_ptr<const runtime::SceneEmbedding> embedding);
  SceneAttention(SceneAttention&&) noexcept;
  SceneAttention& operator=(SceneAttention&&) noexcept;
  ~SceneAttention();

  /// The latents: scene points, world space, with the sides that they lie on.
  std::span<const Vec3> positions() const;
  std::span<const Vec3> normals() const;
  /// The latent that lies nearest to a point among those that face as it does; nearest of all where
  /// none near it does.
  int64_t latent_at(const Vec3& position, const Vec3& normal) const;

  const std::vector<AttentionBlock>& blocks() const;
  size_t decoder_layers() const;
  /// Of all heads of a block, the mean: entropy of what points attend to over that of the plain
  /// mean, in [0, 1]; NaN for a block of one point. Takes time that grows with the square of the
  /// points of a patch.
  double entropy(size_t block) const;

  /// @throws lte::Error as runtime::SceneEmbedding::decode()
  LatentsRead read(const Vec3& position, const Vec3& normal, const Rgb& albedo) const;

  /// How much of what a latent took each latent gave, as a multiple of an even share: an entry a
  /// latent, 1 everywhere where attention is the plain mean. Latents that are one point at the
  /// block's resolution have that point's.
  /// @param head  kAllHeads for the mean over them
  /// @throws lte::Error for a block, head or latent that there is not
  std::vector<float> attention(size_t block, int64_t head, int64_t latent) const;
  static constexpr int64_t kAllHeads = -1;

  /// Values at latents, carried to points of surfaces: from the few latents around each, those that
  /// face as it does before others, by the inverse of squared distance.
  std::vector<float> interpolate(std::span<const float> values, std::span<const Vec3> position,
                                 std::span<const Vec3> normal) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace lte::experiments
