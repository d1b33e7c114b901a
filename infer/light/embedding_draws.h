// Several embeddings of one scene that answer as one.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// Embeddings of one scene by one network, each of scene points and light estimates of its own.
/// What the network makes of a scene moves with where the points fall; the mean of several answers
/// moves less, and lies nearer to the truth.
class EmbeddingDraws {
 public:
  void add(std::shared_ptr<const runtime::SceneEmbedding> embedding);
  void clear() { draws_.clear(); }

  bool empty() const { return draws_.empty(); }
  size_t count() const { return draws_.size(); }
  /// @throws lte::Error if there is none.
  const std::shared_ptr<const runtime::SceneEmbedding>& first() const;
  const runtime::Network& network() const { return first()->network(); }

  /// The means of SceneEmbedding::decode() and decode_radiance(): those of a single embedding to
  /// the last bit where there is one.
  std::vector<Rgb> decode(const runtime::QueryPoints& queries) const;
  std::vector<Rgb> decode_radiance(const runtime::QueryPoints& queries,
                                   std::span<const Vec3> directions) const;

 private:
  std::vector<std::shared_ptr<const runtime::SceneEmbedding>> draws_;
};

}  // namespace lte::infer
