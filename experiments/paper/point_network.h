// What the paper made of the point network of Hermosilla et al. (2019) to compare itself with:
// PointConv (Wu et al. 2019) over points that carry their direct light, on levels of so many points
// each, 64 channels wide, one color channel at a time.
#pragma once

#include <cstdint>
#include <vector>

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include "lte/nn/blocks/layer_norm.h"
#include "lte/nn/blocks/mlp.h"
#include "lte/nn/points/point_set.h"

namespace lte::experiments {

/// Where the features of a convolution lie around the places that it answers at.
struct Neighbourhood {
  at::Tensor index;    ///< [Q, K] into the features
  at::Tensor offset;   ///< [Q, K, 3], over the mean distance of the farthest of K
  at::Tensor density;  ///< [Q, K, 1], inverse density of the features over its mean
};

/// @param places  [Q, 3], answered at
/// @param points  [N, 3], of the features
Neighbourhood neighbourhood(const at::Tensor& places, const at::Tensor& points, int64_t neighbours);

/// A convolution over points: the weights of a feature are a function of where it lies, and are
/// scaled by a function of the density there. Summed before the matrix is applied, so that memory
/// holds no matrix a neighbour. Parameters: `weight.*`, `scale.*`, `output.*`, `norm.*`.
class PointConvImpl : public torch::nn::Module {
 public:
  PointConvImpl(int64_t inputs, int64_t outputs);

  /// @param features  [B, N, inputs]
  /// @return          [B, Q, outputs]
  at::Tensor forward(const at::Tensor& features, const Neighbourhood& at);

 private:
  nn::Mlp weight_{nullptr}, scale_{nullptr};
  nn::Linear output_{nullptr};
  nn::LayerNorm norm_{nullptr};
};
TORCH_MODULE(PointConv);

/// The geometry that the network reads of a scene: levels of ever fewer points, by farthest point
/// sampling, and what is near what.
struct PointLevels {
  at::Tensor attributes;            ///< [3, N, 5]: normal, direct light and albedo of a channel
  at::Tensor scale;                 ///< [3] float64: emission scale
  at::Tensor position;              ///< [N, 3]
  Neighbourhood first;              ///< the finest level at its own points
  std::vector<Neighbourhood> down;  ///< each level at the points of the next
  Neighbourhood coarsest;           ///< the last level at its own points
  std::vector<Neighbourhood> up;    ///< each level but the first at the points of that before
};

/// @param points  with direct light on both sides
PointLevels point_levels(const nn::PointSet& points);

/// Parameters: `first.*`, `down<I>.*`, `coarsest.*`, `up<I>.*`, `last.*`, `head.*`.
class PointNetworkImpl : public torch::nn::Module {
 public:
  static constexpr int64_t kWidth = 64, kLevels = 4;

  /// @param output_mean  of the answers at first
  explicit PointNetworkImpl(double output_mean);

  /// @return  [Q, 3] indirect irradiance over the emission scale, non-negative
  at::Tensor forward(const PointLevels& levels, const nn::QuerySet& queries);

 private:
  PointConv first_{nullptr}, coarsest_{nullptr}, last_{nullptr};
  std::vector<PointConv> down_, up_;
  nn::Mlp head_{nullptr};
};
TORCH_MODULE(PointNetwork);

}  // namespace lte::experiments
