// The network as a plain PyTorch user would write it, the peer of lte_bench's figures: tensor
// operations of LibTorch alone, keys and values projected for every pair of query and neighbour,
// farthest point sampling as a loop over the picks, neighbours by cdist and topk, attention as
// softmax(Q Kᵀ) V. Nothing is shared with lte::nn but the parameters and the maps of the curves.
#pragma once

#include <functional>
#include <map>
#include <string>

#include <ATen/core/Tensor.h>

#include "lte/nn/encoder/encoder_plan.h"
#include "lte/nn/model.h"

namespace lte::bench {

class EagerNetwork {
 public:
  explicit EagerNetwork(const nn::LightTransportModel& model);

  /// Picks of farthest point sampling, [count] int64, from point 0.
  static at::Tensor farthest_points(const at::Tensor& points, int64_t count);
  /// [Q, min(k, N)] int64, nearest first.
  static at::Tensor nearest(const at::Tensor& queries, const at::Tensor& points, int64_t k);

  /// Points to latents, [m, D]. Both halvings are sampled here, and the neighbours of the
  /// convolutions found.
  /// @param plan  its cells, clusters and patches are taken as they are: 1 % of this peer's time
  at::Tensor encode(const nn::PointSet& points, const nn::EncoderPlan& plan) const;

  /// Irradiance over the emission scalar, [Q, 3], in blocks that hold [block, κ, D] tensors.
  at::Tensor decode(const nn::Embedding& embedding, const nn::QuerySet& queries,
                    int64_t block) const;

 private:
  using Pairs = std::vector<std::pair<at::Tensor, at::Tensor>>;  ///< a tap: outputs, inputs

  at::Tensor linear(const std::string& name, const at::Tensor& x) const;
  at::Tensor norm(const std::string& name, const at::Tensor& x) const;
  at::Tensor perceptron(const std::string& name, const at::Tensor& x) const;
  at::Tensor neighbour_max(const std::string& name, const at::Tensor& dense,
                           const at::Tensor& center, const at::Tensor& neighbour) const;
  static Pairs find_pairs(const at::Tensor& cells, int64_t kernel);
  at::Tensor convolution(const std::string& name, const at::Tensor& x, const Pairs& pairs) const;
  at::Tensor attention(const std::string& name, const at::Tensor& x, const nn::PatchMap& map) const;
  at::Tensor stage(const std::string& name, int64_t depth, at::Tensor x, const nn::StagePlan& plan,
                   const Pairs& pairs) const;
  at::Tensor point_transformer(const at::Tensor& x, const nn::EncoderPlan& plan) const;

  nn::ModelConfig config_;
  std::map<std::string, at::Tensor> parameters_;
};

}  // namespace lte::bench
