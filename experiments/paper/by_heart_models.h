// What learns irradiance in one scene by heart: a multiresolution hash grid (Müller et al. 2022)
// and latents that are parameters themselves, read by the mean of the nearest or by the query
// decoder.
#pragma once

#include <cstdint>
#include <tuple>

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include "experiments/paper/roadmap_model.h"
#include "lte/nn/blocks/mlp.h"
#include "lte/nn/decoder/query_decoder.h"

namespace lte::experiments {

struct HashGridConfig {
  int64_t levels = 16, features = 2;
  int64_t log2_entries = 15;  ///< of the table of a level
  int64_t base = 16;          ///< cells along an axis of the coarsest level
  double growth = 1.5;        ///< from a level to the next
};

/// Trilinear interpolation of features at the corners of the cells of several grids. A level with
/// more corners than entries shares them by a hash. Parameter: `table` [levels, entries, features].
class HashGridImpl : public torch::nn::Module {
 public:
  explicit HashGridImpl(const HashGridConfig& config);

  /// @param position  [Q, 3] in [0, 1]
  /// @return          [Q, levels · features]
  at::Tensor forward(const at::Tensor& position);

  /// Entries of the eight corners of each position's cell at a level, [Q, 8] int64, and their
  /// weights, [Q, 8], which sum to 1.
  std::tuple<at::Tensor, at::Tensor> corners(const at::Tensor& position, int64_t level) const;

  int64_t cells(int64_t level) const;
  const at::Tensor& table() const { return table_; }

 private:
  HashGridConfig config_;
  at::Tensor table_;
};
TORCH_MODULE(HashGrid);

/// Something that answers irradiance in one scene.
class ByHeartImpl : public torch::nn::Module {
 public:
  /// @param attributes  [Q, 9] of the queries, as the query decoder's
  /// @param query       position in network space, and normal
  /// @return            [Q, 3], non-negative
  virtual at::Tensor forward(const at::Tensor& attributes, const nn::Surface& query) = 0;
};

/// A hash grid, normal and albedo, through two hidden layers. Parameters: `grid.*`, `hidden.*`,
/// `head.*`.
class GridByHeart : public ByHeartImpl {
 public:
  /// @param extent  of the scene in network space, per axis at most
  GridByHeart(const HashGridConfig& config, double extent, double output_mean);
  at::Tensor forward(const at::Tensor& attributes, const nn::Surface& query) override;

 private:
  double extent_;
  HashGrid grid_{nullptr};
  nn::Mlp hidden_{nullptr}, head_{nullptr};
};

enum class LatentReader { Mean, Decoder };

/// Free latents at scene points. Parameters: `latents` [m, D], and `pool.*` or `decoder.*`.
class LatentsByHeart : public ByHeartImpl {
 public:
  /// @param anchor  position in network space, and normal, of m scene points
  LatentsByHeart(LatentReader reader, const nn::Surface& anchor, double spacing,
                 const nn::ModelConfig& config);
  at::Tensor forward(const at::Tensor& attributes, const nn::Surface& query) override;

 private:
  nn::Surface anchor_;
  double spacing_;
  at::Tensor latents_;
  NeighbourMean pool_{nullptr};
  nn::QueryDecoder decoder_{nullptr};
};

}  // namespace lte::experiments
