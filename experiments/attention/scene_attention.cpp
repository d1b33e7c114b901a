#include "experiments/attention/scene_attention.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/nn/encoder/attention_record.h"
#include "lte/nn/model.h"
#include "lte/nn/one_line_errors.h"
#include "lte/ops/knn.h"
#include "lte/runtime/tensors.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"

namespace lte::experiments {
namespace {

using runtime::borrow;
using runtime::SceneEmbedding;
using runtime::TorchParts;

/// Latents around a point that say what is there.
constexpr int64_t kAround = 4;
/// Latents around a point among which one that faces as it does is looked for.
constexpr int64_t kLookedAt = 32;
constexpr float kFaces = 0.5f;
/// What a latent that faces another way counts for, over one that faces as the point does.
constexpr float kOtherSide = 1e-4f;

std::vector<Vec3> vectors(const at::Tensor& rows) {
  const at::Tensor host = rows.to(at::kCPU, at::kFloat).contiguous();
  const auto* data = reinterpret_cast<const Vec3*>(host.const_data_ptr<float>());
  return {data, data + host.size(0)};
}

std::vector<float> numbers(const at::Tensor& values) {
  const at::Tensor host = values.to(at::kCPU, at::kFloat).contiguous();
  const auto* data = host.const_data_ptr<float>();
  return {data, data + host.numel()};
}

}  // namespace

struct SceneAttention::Parts {
  std::shared_ptr<const SceneEmbedding> embedding;
  const nn::EncoderAttention* record = nullptr;
  std::vector<Vec3> position, normal;
  std::vector<AttentionBlock> blocks;

  /// [n, k] int64 on the CPU, the latents nearest to each of n points.
  at::Tensor around(std::span<const Vec3> points, int64_t k) const {
    return std::get<0>(ops::knn(borrow(points), borrow(position), k));
  }
};

SceneAttention::SceneAttention(std::shared_ptr<const SceneEmbedding> embedding) {
  auto parts = std::make_unique<Parts>();
  parts->embedding = std::move(embedding);
  parts->record = TorchParts::attention(*parts->embedding);
  LTE_CHECK(parts->record != nullptr,
            "the encoder's attention was not recorded when this embedding was made");
  const nn::Embedding latents = TorchParts::embedding(*parts->embedding);
  parts->position = vectors(latents.position * latents.scale + latents.origin);
  parts->normal = vectors(parts->record->normal);
  for (const nn::BlockAttention& block : parts->record->blocks)
    parts->blocks.push_back({block.name, block.heads, block.points()});
  parts_ = std::move(parts);
}

SceneAttention::SceneAttention(SceneAttention&&) noexcept = default;
SceneAttention& SceneAttention::operator=(SceneAttention&&) noexcept = default;
SceneAttention::~SceneAttention() = default;

std::span<const Vec3> SceneAttention::positions() const { return parts_->position; }
std::span<const Vec3> SceneAttention::normals() const { return parts_->normal; }
const std::vector<AttentionBlock>& SceneAttention::blocks() const { return parts_->blocks; }

size_t SceneAttention::decoder_layers() const {
  return static_cast<size_t>(parts_->embedding->network().config().query_layers);
}

int64_t SceneAttention::latent_at(const Vec3& position, const Vec3& normal) const {
  const at::Tensor near = parts_->around({&position, 1}, kLookedAt);
  const std::span<const int64_t> order(near.const_data_ptr<int64_t>(),
                                       static_cast<size_t>(near.numel()));
  const auto facing = std::find_if(order.begin(), order.end(), [&](int64_t latent) {
    return dot(parts_->normal[static_cast<size_t>(latent)], normal) > kFaces;
  });
  return facing == order.end() ? order.front() : *facing;
}

double SceneAttention::entropy(size_t block) const {
  return parts_->record->blocks.at(block).entropy();
}

LatentsRead SceneAttention::read(const Vec3& position, const Vec3& normal,
                                 const Rgb& albedo) const {
  const SceneEmbedding& embedding = *parts_->embedding;
  const c10::Device device = runtime::torch_device(embedding.network().device());
  const nn::QuerySet query = {borrow(std::span(&position, 1)).to(device),
                              borrow(std::span(&normal, 1)).to(device),
                              borrow(std::span(&albedo, 1)).to(device)};
  const nn::DecoderReading reading = nn::one_line_errors([&] {
    return TorchParts::model(embedding.network())->read(TorchParts::embedding(embedding), query);
  });
  const at::Tensor shares = reading.shares().select(1, 0);  // [L, κ]
  LatentsRead out;
  const at::Tensor index = reading.index[0].to(at::kCPU).contiguous();
  out.latent.assign(index.const_data_ptr<int64_t>(),
                    index.const_data_ptr<int64_t>() + index.numel());
  out.share = numbers(shares.mean(0));
  for (int64_t layer = 0; layer < shares.size(0); ++layer)
    out.by_layer.push_back(numbers(shares[layer]));
  return out;
}

std::vector<float> SceneAttention::attention(size_t block, int64_t head, int64_t latent) const {
  const std::vector<AttentionBlock>& blocks = parts_->blocks;
  LTE_CHECK(block < blocks.size(), "block ", block, ": the encoder has ", blocks.size());
  LTE_CHECK(head >= kAllHeads && head < blocks[block].heads, "head ", head, ": block ",
            blocks[block].name, " has ", blocks[block].heads);
  LTE_CHECK(latent >= 0 && latent < static_cast<int64_t>(parts_->position.size()), "latent ",
            latent, ": the scene has ", parts_->position.size());
  const at::Tensor rows = parts_->record->weights(block, latent);
  const at::Tensor row = head == kAllHeads ? rows.mean(0) : rows[head];
  const size_t level = parts_->record->blocks[block].level;
  return numbers(row.index_select(0, parts_->record->point_of_latent[level])
                     .mul(static_cast<double>(row.size(0))));
}

std::vector<float> SceneAttention::interpolate(std::span<const float> values,
                                               std::span<const Vec3> position,
                                               std::span<const Vec3> normal) const {
  LTE_CHECK(values.size() == parts_->position.size() && position.size() == normal.size(),
            "expected a value a latent and a normal a point, got ", values.size(), " for ",
            parts_->position.size(), " and ", normal.size(), " for ", position.size());
  std::vector<float> out(position.size());
  if (position.empty()) return out;
  const at::Tensor near = parts_->around(position, kAround);
  const auto* rows = near.const_data_ptr<int64_t>();
  const auto around = static_cast<size_t>(near.size(1));
  for (size_t i = 0; i < position.size(); ++i) {
    double sum = 0, total = 0;
    for (size_t k = 0; k < around; ++k) {
      const auto latent = static_cast<size_t>(rows[i * around + k]);
      const Vec3 way = position[i] - parts_->position[latent];
      const float facing = std::max(0.0f, dot(normal[i], parts_->normal[latent]));
      // The least distance keeps the weight of a point on a latent finite.
      const double weight = (facing * facing + kOtherSide) / std::max(dot(way, way), 1e-12f);
      sum += weight * double{values[latent]};
      total += weight;
    }
    out[i] = static_cast<float>(sum / total);
  }
  return out;
}

}  // namespace lte::experiments
