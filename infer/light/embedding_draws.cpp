#include "infer/light/embedding_draws.h"

#include <utility>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

template <typename Ask>
std::vector<Rgb> mean_of(const std::vector<std::shared_ptr<const runtime::SceneEmbedding>>& draws,
                         const Ask& ask) {
  std::vector<Rgb> mean = ask(*draws.front());
  if (draws.size() == 1) return mean;
  for (size_t k = 1; k < draws.size(); ++k) {
    const std::vector<Rgb> other = ask(*draws[k]);
    for (size_t i = 0; i < mean.size(); ++i) mean[i] += other[i];
  }
  const float share = 1 / static_cast<float>(draws.size());
  for (Rgb& value : mean) value = value * share;
  return mean;
}

}  // namespace

void EmbeddingDraws::add(std::shared_ptr<const runtime::SceneEmbedding> embedding) {
  draws_.push_back(std::move(embedding));
}

const std::shared_ptr<const runtime::SceneEmbedding>& EmbeddingDraws::first() const {
  LTE_CHECK(!empty(), "there is no embedding: embed() comes first");
  return draws_.front();
}

std::vector<Rgb> EmbeddingDraws::decode(const runtime::QueryPoints& queries) const {
  first();
  return mean_of(draws_, [&](const runtime::SceneEmbedding& draw) { return draw.decode(queries); });
}

std::vector<Rgb> EmbeddingDraws::decode_radiance(const runtime::QueryPoints& queries,
                                                 std::span<const Vec3> directions) const {
  first();
  return mean_of(draws_, [&](const runtime::SceneEmbedding& draw) {
    return draw.decode_radiance(queries, directions);
  });
}

}  // namespace lte::infer
