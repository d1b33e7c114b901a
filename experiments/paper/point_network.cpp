#include "experiments/paper/point_network.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <ATen/ATen.h>

#include "lte/base/check.h"
#include "lte/nn/decoder/query_decoder.h"
#include "lte/nn/encoder/transformer_block.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/gelu.h"
#include "lte/ops/knn.h"

namespace lte::experiments {
namespace {

constexpr int64_t kInputs = 5;          // of a point, one channel of color
constexpr int64_t kWeights = 16;        // functions of an offset
constexpr int64_t kWeightHidden = 8;    // as PointConv's
constexpr int64_t kNeighbours = 16;     // of a convolution
constexpr int64_t kFromCoarser = 8;     // of one that goes up
constexpr int64_t kEverywhere = 32;     // of the coarsest
constexpr int64_t kPointsPerPoint = 4;  // of the level before

at::Tensor contiguous(const at::Tensor& x) { return x.to(at::kFloat).contiguous(); }

/// Square of the distance to the farthest of some neighbours: inverse density on a surface.
at::Tensor inverse_density(const at::Tensor& points) {
  const at::Tensor far = std::get<1>(ops::knn(points, points, kNeighbours)).select(1, -1);
  return far / far.mean().clamp_min(1e-12);
}

}  // namespace

Neighbourhood neighbourhood(const at::Tensor& places, const at::Tensor& points,
                            int64_t neighbours) {
  const auto [index, distance] = ops::knn(contiguous(places), contiguous(points), neighbours);
  const int64_t Q = index.size(0), K = index.size(1);
  const at::Tensor row = index.reshape({-1});
  const at::Tensor offset = points.index_select(0, row).view({Q, K, 3}) - places.unsqueeze(1);
  const at::Tensor reach = distance.select(1, -1).sqrt().mean().clamp_min(1e-6);
  return {index, offset / reach,
          inverse_density(contiguous(points)).index_select(0, row).view({Q, K, 1})};
}

PointConvImpl::PointConvImpl(int64_t inputs, int64_t outputs)
    : weight_(register_module("weight", nn::Mlp(3, kWeightHidden, kWeights))),
      scale_(register_module("scale", nn::Mlp(1, kWeightHidden, 1))),
      output_(register_module("output", nn::Linear(inputs * kWeights, outputs))),
      norm_(register_module("norm", nn::LayerNorm(outputs))) {
  nn::initialize(output_, 1);
}

at::Tensor PointConvImpl::forward(const at::Tensor& features, const Neighbourhood& at) {
  const int64_t B = features.size(0), C = features.size(2), Q = at.index.size(0),
                K = at.index.size(1);
  const at::Tensor weights = weight_->forward(at.offset) *
                             at::sigmoid(scale_->forward(at.density)) /
                             std::sqrt(static_cast<double>(K));
  const at::Tensor near =
      features.index_select(1, at.index.reshape({-1})).view({B, Q, K, C}).transpose(2, 3);
  const at::Tensor sums = at::matmul(near, weights).reshape({B, Q, C * kWeights});
  return ops::gelu(norm_->forward(output_->forward(sums)));
}

PointLevels point_levels(const nn::PointSet& points) {
  LTE_CHECK(points.direct.defined() && points.direct_back.defined(),
            "the point network reads direct light, which the scene points lack");
  PointLevels out;
  out.scale = nn::emission_scale(points);
  const at::Tensor scale = at::where(out.scale > 0, out.scale, 1).to(at::kFloat);
  const at::Tensor front = (points.direct - points.direct_back).clamp_min(0).div(scale).log1p();
  const at::Tensor normal = points.normal.unsqueeze(0).expand({3, -1, -1});
  out.attributes = at::cat({normal, front.t().unsqueeze(2), points.albedo.t().unsqueeze(2)}, 2);
  out.position = points.position;
  out.first = neighbourhood(points.position, points.position, kNeighbours);
  at::Tensor finer = points.position;
  for (int64_t level = 1; level < PointNetworkImpl::kLevels; ++level) {
    const int64_t count = std::max<int64_t>(1, finer.size(0) / kPointsPerPoint);
    const at::Tensor coarser =
        finer.index_select(0, std::get<0>(ops::farthest_point_sampling(contiguous(finer), count)));
    out.down.push_back(neighbourhood(coarser, finer, kNeighbours));
    out.up.push_back(neighbourhood(finer, coarser, kFromCoarser));
    finer = coarser;
  }
  out.coarsest = neighbourhood(finer, finer, kEverywhere);
  return out;
}

PointNetworkImpl::PointNetworkImpl(double output_mean)
    : first_(register_module("first", PointConv(kInputs, kWidth))),
      coarsest_(register_module("coarsest", PointConv(kWidth, kWidth))),
      last_(register_module("last", PointConv(kWidth, kWidth))),
      head_(register_module("head", nn::Mlp(kWidth + 3, kWidth, 1, 0, 0.1))) {
  for (int64_t i = 0; i + 1 < kLevels; ++i) {
    down_.push_back(register_module("down" + std::to_string(i), PointConv(kWidth, kWidth)));
    up_.push_back(register_module("up" + std::to_string(i), PointConv(kWidth, kWidth)));
  }
  const at::NoGradGuard no_grad;
  head_->output()->bias.fill_(nn::softplus_inverse(output_mean));
}

at::Tensor PointNetworkImpl::forward(const PointLevels& levels, const nn::QuerySet& queries) {
  at::Tensor x = first_->forward(levels.attributes, levels.first);
  std::vector<at::Tensor> own;
  for (size_t i = 0; i < down_.size(); ++i) {
    own.push_back(x);
    x = down_[i]->forward(x, levels.down[i]);
  }
  x = x + coarsest_->forward(x, levels.coarsest);
  for (size_t i = down_.size(); i-- > 0;) x = own[i] + up_[i]->forward(x, levels.up[i]);
  x = last_->forward(x, neighbourhood(queries.position, levels.position, kFromCoarser));
  const at::Tensor normal = queries.normal.unsqueeze(0).expand({3, -1, -1});
  return at::softplus(head_->forward(at::cat({x, normal}, 2))).squeeze(2).t();
}

}  // namespace lte::experiments
