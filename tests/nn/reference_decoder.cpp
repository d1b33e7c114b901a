#include "tests/nn/reference_decoder.h"

#include <algorithm>
#include <cmath>

namespace lte::test {
namespace {

using Parameters = std::map<std::string, at::Tensor>;

at::Tensor linear(const Parameters& p, const std::string& name, const at::Tensor& x) {
  return torch::matmul(x, p.at(name + ".weight").t()) + p.at(name + ".bias");
}

at::Tensor exact_gelu(const at::Tensor& x) {
  return 0.5 * x * (1 + torch::erf(x / std::sqrt(2.0)));
}

at::Tensor perceptron(const Parameters& p, const std::string& name, const at::Tensor& x) {
  return linear(p, name + ".output", exact_gelu(linear(p, name + ".hidden", x)));
}

at::Tensor normalize(const Parameters& p, const std::string& name, const at::Tensor& x) {
  const at::Tensor centered = x - x.mean(-1, true);
  const at::Tensor variance = centered.square().mean(-1, true);
  return centered / torch::sqrt(variance + 1e-5) * p.at(name + ".weight") + p.at(name + ".bias");
}

}  // namespace

at::Tensor reference_decoder(const Parameters& p, const nn::ModelConfig& config,
                             const at::Tensor& attributes, const nn::Surface& query,
                             const nn::Surface& anchor, const at::Tensor& latent, double spacing) {
  const at::Tensor offset = query.position.unsqueeze(1) - anchor.position.unsqueeze(0);
  const int64_t k = std::min(config.query_neighbours, anchor.position.size(0));
  const at::Tensor nearest = std::get<1>(offset.square().sum(-1).topk(k, 1, /*largest=*/false));
  const at::Tensor near_offset = offset.gather(1, nearest.unsqueeze(-1).expand({-1, -1, 3}));
  const at::Tensor KV = latent.index({nearest});  // [Q, k, D]

  at::Tensor pair = near_offset / spacing;
  if (config.reads_normals()) {
    const at::Tensor n = query.normal, n_k = anchor.normal.index({nearest});
    pair = torch::cat({pair, torch::einsum("qx,qkx->qk", {n, n_k}).unsqueeze(2),
                       torch::einsum("qx,qkx->qk", {n, pair}).unsqueeze(2),
                       torch::einsum("qkx,qkx->qk", {n_k, pair}).unsqueeze(2)},
                      2);
  }
  const at::Tensor P = perceptron(p, "gamma", pair);
  at::Tensor G = perceptron(p, "point", attributes);
  for (int64_t l = 0; l < config.query_layers; ++l) {
    const std::string layer = "layer" + std::to_string(l) + ".";
    const at::Tensor q = linear(p, layer + "query", normalize(p, layer + "norm1", G));
    const at::Tensor key = linear(p, layer + "key", KV), value = linear(p, layer + "value", KV);
    const at::Tensor A = q.unsqueeze(1) - key + P;
    const at::Tensor weight = A / static_cast<double>(k);
    G = G + linear(p, layer + "output", (weight * (value + P)).sum(1));
    G = G + perceptron(p, layer + "ffn", normalize(p, layer + "norm2", G));
  }
  return torch::log1p(torch::exp(perceptron(p, "head", normalize(p, "norm", G))));
}

}  // namespace lte::test
