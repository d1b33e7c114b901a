#include "lte/nn/encoder/nearest_neighbour_embedding.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/nn/blocks/recompute.h"
#include "lte/ops/gelu.h"
#include "lte/ops/neighbour_max.h"

namespace lte::nn {

NeighbourMaxImpl::NeighbourMaxImpl(int64_t channels)
    : hidden_(register_module("hidden", Linear(2 * channels, channels))),
      output_(register_module("output", Linear(channels, channels))) {
  initialize(hidden_, std::sqrt(2.0));
  initialize(output_, 1);
}

at::Tensor NeighbourMaxImpl::forward(const at::Tensor& dense, const at::Tensor& center,
                                     const at::Tensor& neighbour) {
  const std::vector<at::Tensor> weight = hidden_->weight.chunk(2, 1);  // W_a, W_b
  const at::Tensor of_dense = hidden_->product(dense, weight[0]);
  const at::Tensor of_center = hidden_->product(center, weight[1] - weight[0], hidden_->bias);
  if (!at::GradMode::is_enabled() && dense.device().is_cpu() && dense.scalar_type() == at::kFloat) {
    return ops::neighbour_max_inference(of_dense, of_center, neighbour, output_->inference_weight(),
                                        output_->bias);
  }
  if (fuses(of_dense)) {
    return ops::neighbour_max(of_dense, of_center, neighbour, output_->weights());
  }
  const int64_t m = neighbour.size(0), k = neighbour.size(1), D = of_dense.size(1);
  const int64_t rows = std::max<int64_t>(1, std::min(m, rows_of_a_block(k * D, dense.device())));
  std::vector<at::Tensor> out;
  for (int64_t begin = 0; begin < m; begin += rows) {
    const int64_t count = std::min(rows, m - begin);
    const at::Tensor index = neighbour.narrow(0, begin, count).reshape({-1});
    const auto block = [this, index, count, k, D](const std::vector<at::Tensor>& projected) {
      at::Tensor pair = projected[0].index_select(0, index).view({count, k, D});
      pair = ops::gelu(pair + projected[1].unsqueeze(1));
      return std::vector<at::Tensor>{at::amax(output_->forward(pair), {1})};
    };
    const std::vector<at::Tensor> projected = {of_dense, of_center.narrow(0, begin, count)};
    out.push_back(rows < m ? recompute(block, projected, output_->parameters())[0]
                           : block(projected)[0]);
  }
  return out.size() == 1 ? out[0] : at::cat(out);
}

bool NeighbourMaxImpl::fuses(const at::Tensor& projected) const {
  return projected.device().is_cpu() && projected.scalar_type() == at::kFloat &&
         projected.size(1) % ops::kMaximumBlock == 0;
}

NearestNeighbourEmbeddingImpl::NearestNeighbourEmbeddingImpl(int64_t inputs, int64_t channels)
    : point_(register_module("point", Mlp(inputs, channels, channels))),
      first_(register_module("first", NeighbourMax(channels))),
      second_(register_module("second", NeighbourMax(channels))) {}

at::Tensor NearestNeighbourEmbeddingImpl::forward(const at::Tensor& attributes,
                                                  const EncoderPlan& plan) {
  const at::Tensor points = point_->forward(attributes);
  const at::Tensor halved =
      first_->forward(points, points.index_select(0, plan.first_picks), plan.first_neighbours);
  const bool alone = plan.stages.front().scenes.size() == 1;  // then a run, which needs no copy
  const at::Tensor centers = alone ? halved.narrow(0, 0, plan.position.size(0))
                                   : halved.index_select(0, plan.second_picks);
  return second_->forward(halved, centers, plan.second_neighbours);
}

}  // namespace lte::nn
