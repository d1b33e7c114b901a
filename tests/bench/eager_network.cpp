#include "tests/bench/eager_network.h"

#include <algorithm>
#include <cmath>

#include <ATen/ATen.h>

namespace lte::bench {
namespace {

at::Tensor attributes(const at::Tensor& position, const at::Tensor& normal,
                      const at::Tensor& albedo) {
  return at::cat({position.clamp(-4, 4) * 4, normal, albedo}, 1);
}

}  // namespace

EagerNetwork::EagerNetwork(const nn::LightTransportModel& model) : config_(model->config()) {
  for (const auto& item : model->named_parameters()) {
    parameters_[item.key()] = item.value().detach();
  }
}

at::Tensor EagerNetwork::linear(const std::string& name, const at::Tensor& x) const {
  const auto bias = parameters_.find(name + ".bias");
  return bias == parameters_.end() ? at::linear(x, parameters_.at(name + ".weight"))
                                   : at::linear(x, parameters_.at(name + ".weight"), bias->second);
}

at::Tensor EagerNetwork::norm(const std::string& name, const at::Tensor& x) const {
  return at::layer_norm(x, {x.size(-1)}, parameters_.at(name + ".weight"),
                        parameters_.at(name + ".bias"));
}

at::Tensor EagerNetwork::perceptron(const std::string& name, const at::Tensor& x) const {
  return linear(name + ".output", at::gelu(linear(name + ".hidden", x)));
}

at::Tensor EagerNetwork::farthest_points(const at::Tensor& points, int64_t count) {
  at::Tensor picks = at::zeros({count}, at::kLong);
  at::Tensor distance = at::full({points.size(0)}, INFINITY);
  int64_t last = 0;
  for (int64_t i = 0; i < count; ++i) {
    picks[i] = last;
    distance = at::minimum(distance, (points - points[last]).square().sum(1));
    last = distance.argmax().item<int64_t>();
  }
  return picks;
}

at::Tensor EagerNetwork::nearest(const at::Tensor& queries, const at::Tensor& points, int64_t k) {
  std::vector<at::Tensor> found;
  for (const at::Tensor& block : queries.split(2048)) {
    // Without the product form, whose rounding would give other neighbours than ours.
    const at::Tensor distance = at::cdist(block, points, 2, /*compute_mode=*/2);
    found.push_back(std::get<1>(distance.topk(std::min(k, points.size(0)), 1, /*largest=*/false)));
  }
  return at::cat(found);
}

at::Tensor EagerNetwork::neighbour_max(const std::string& name, const at::Tensor& dense,
                                       const at::Tensor& center,
                                       const at::Tensor& neighbour) const {
  std::vector<at::Tensor> out;
  for (int64_t begin = 0; begin < center.size(0); begin += 1024) {
    const int64_t count = std::min<int64_t>(1024, center.size(0) - begin);
    const at::Tensor x = dense.index({neighbour.narrow(0, begin, count)});  // [count, k, D]
    const at::Tensor c = center.narrow(0, begin, count).unsqueeze(1).expand_as(x);
    out.push_back(perceptron(name, at::cat({x - c, c}, 2)).amax({1}));
  }
  return at::cat(out);
}

EagerNetwork::Pairs EagerNetwork::find_pairs(const at::Tensor& cells, int64_t kernel) {
  const auto key = [](const at::Tensor& c) {
    return (c.select(1, 0) * (1 << 20) + c.select(1, 1)) * (1 << 20) + c.select(1, 2);
  };
  const at::Tensor cell = cells.to(at::kLong) + kernel;
  const auto [sorted, order] = key(cell).sort(/*stable=*/true, 0, false);
  const at::Tensor rows = at::arange(cells.size(0));
  Pairs pairs;
  for (int64_t tap = 0; tap < kernel * kernel * kernel; ++tap) {
    const int64_t dx = tap / (kernel * kernel), dy = tap / kernel % kernel, dz = tap % kernel;
    if (dx == kernel / 2 && dy == dx && dz == dx) {
      pairs.emplace_back(rows, rows);
      continue;
    }
    const at::Tensor wanted = key(cell + at::tensor({dx, dy, dz}) - kernel / 2);
    const at::Tensor place = at::searchsorted(sorted, wanted).clamp_max(cells.size(0) - 1);
    const at::Tensor output = sorted.index_select(0, place).eq(wanted).nonzero().squeeze(1);
    pairs.emplace_back(output, order.index_select(0, place.index_select(0, output)));
  }
  return pairs;
}

at::Tensor EagerNetwork::convolution(const std::string& name, const at::Tensor& x,
                                     const Pairs& pairs) const {
  const at::Tensor& weight = parameters_.at(name + ".weight");
  at::Tensor out = at::zeros({x.size(0), weight.size(2)});
  for (size_t tap = 0; tap < pairs.size(); ++tap) {
    const auto& [output, input] = pairs[tap];
    if (output.size(0) == 0) continue;
    out.index_add_(0, output, at::mm(x.index_select(0, input), weight[static_cast<int64_t>(tap)]));
  }
  const auto bias = parameters_.find(name + ".bias");
  return bias == parameters_.end() ? out : out + bias->second;
}

at::Tensor EagerNetwork::attention(const std::string& name, const at::Tensor& x,
                                   const nn::PatchMap& map) const {
  const int64_t C = x.size(1), heads = std::max<int64_t>(1, C / config_.head_width);
  const bool one_patch = !map.gather.defined();
  at::Tensor qkv = linear(name + ".qkv", x);
  if (!one_patch) qkv = qkv.index_select(0, map.gather);
  const int64_t length = one_patch ? x.size(0) : config_.patch_size;
  qkv = qkv.view({-1, length, 3, heads, C / heads}).permute({2, 0, 3, 1, 4});
  const double scale = 1 / std::sqrt(static_cast<double>(C) / static_cast<double>(heads));
  const at::Tensor weight = at::softmax(at::matmul(qkv[0] * scale, qkv[1].transpose(2, 3)), -1);
  at::Tensor out = at::matmul(weight, qkv[2]).transpose(1, 2).reshape({-1, C});
  if (!one_patch) out = out.index_select(0, map.inverse);
  return linear(name + ".proj", out);
}

at::Tensor EagerNetwork::stage(const std::string& name, int64_t depth, at::Tensor x,
                               const nn::StagePlan& plan, const Pairs& pairs) const {
  for (int64_t i = 0; i < depth; ++i) {
    const std::string block = name + "." + std::to_string(i) + ".";
    const at::Tensor local = linear(block + "conv_linear", convolution(block + "conv", x, pairs));
    x = x + norm(block + "conv_norm", local);
    const std::vector<nn::PatchMap>& patches = plan.scenes.front().patches;
    const nn::PatchMap& map = patches[static_cast<size_t>(i) % patches.size()];
    x = x + attention(block + "attention", norm(block + "norm1", x), map);
    x = x + perceptron(block + "mlp", norm(block + "norm2", x));
  }
  return x;
}

at::Tensor EagerNetwork::point_transformer(const at::Tensor& x, const nn::EncoderPlan& plan) const {
  const auto tower = [](const char* part, size_t s) {
    return "encoder." + (part + std::to_string(s));
  };
  const at::Tensor stem =
      convolution("encoder.stem", x, find_pairs(plan.stages[0].cells, config_.stem_kernel()));
  std::vector<at::Tensor> skip = {at::gelu(norm("encoder.stem_norm", stem))};
  std::vector<Pairs> pairs;
  for (size_t s = 0; s < plan.stages.size(); ++s) {
    const nn::StagePlan& level = plan.stages[s];
    pairs.push_back(find_pairs(level.cells, 3));
    if (s > 0) {
      const at::Tensor projected = linear(tower("pool", s) + ".linear", skip.back());
      const at::Tensor target = level.cluster.unsqueeze(1).expand_as(projected);
      const at::Tensor pooled = at::full({level.points(), projected.size(1)}, -INFINITY)
                                    .scatter_reduce(0, target, projected, "amax");
      skip.push_back(at::gelu(norm(tower("pool", s) + ".norm", pooled)));
    }
    skip[s] = stage(tower("down", s), config_.encoder_depths[s], skip[s], level, pairs[s]);
  }
  at::Tensor y = skip.back();
  for (size_t s = plan.stages.size() - 1; s-- > 0;) {
    const std::string name = tower("unpool", s);
    const at::Tensor up = at::gelu(norm(name + ".coarse_norm", linear(name + ".coarse", y)));
    const at::Tensor across = at::gelu(norm(name + ".skip_norm", linear(name + ".skip", skip[s])));
    y = up.index_select(0, plan.stages[s + 1].cluster) + across;
    y = stage(tower("up", s), config_.decoder_depths[s], y, plan.stages[s], pairs[s]);
  }
  return norm("encoder.norm", y);
}

at::Tensor EagerNetwork::encode(const nn::PointSet& points, const nn::EncoderPlan& plan) const {
  const at::Tensor position =
      (points.position - std::get<0>(points.position.min(0))) / config_.scale;
  const at::Tensor a = nn::emission_scale(points);
  const at::Tensor emission = at::log1p(points.emission / at::where(a > 0, a, 1).to(at::kFloat));
  const at::Tensor x = perceptron(
      "nne.point", at::cat({attributes(position, points.normal, points.albedo), emission}, 1));
  const int64_t M = position.size(0), m1 = (M + 1) / 2, m = (m1 + 1) / 2;
  const at::Tensor first = farthest_points(position, m1);
  const at::Tensor halved = position.index_select(0, first);
  const at::Tensor second = farthest_points(halved, m);
  const at::Tensor quartered = halved.index_select(0, second);
  const at::Tensor y = neighbour_max("nne.first", x, x.index_select(0, first),
                                     nearest(halved, position, config_.nne_neighbours));
  const at::Tensor z = neighbour_max("nne.second", y, y.index_select(0, second),
                                     nearest(quartered, halved, config_.nne_neighbours));
  return point_transformer(z, plan);
}

at::Tensor EagerNetwork::decode(const nn::Embedding& embedding, const nn::QuerySet& queries,
                                int64_t block) const {
  std::vector<at::Tensor> out;
  for (int64_t begin = 0; begin < queries.position.size(0); begin += block) {
    const int64_t count = std::min(block, queries.position.size(0) - begin);
    const at::Tensor position =
        (queries.position.narrow(0, begin, count) - embedding.origin) / embedding.scale;
    const at::Tensor near = nearest(position, embedding.position, config_.query_neighbours);
    const at::Tensor latent = embedding.features.index({near});  // [count, κ, D]
    const at::Tensor offset = position.unsqueeze(1) - embedding.position.index({near});
    const at::Tensor P = perceptron("decoder.gamma", (offset / embedding.spacing).clamp(-64, 64));
    at::Tensor G =
        perceptron("decoder.point", attributes(position, queries.normal.narrow(0, begin, count),
                                               queries.albedo.narrow(0, begin, count)));
    for (int64_t l = 0; l < config_.query_layers; ++l) {
      const std::string layer = "decoder.layer" + std::to_string(l) + ".";
      const at::Tensor q = linear(layer + "query", norm(layer + "norm1", G)).unsqueeze(1);
      const at::Tensor k = linear(layer + "key", latent), v = linear(layer + "value", latent);
      G = G + linear(layer + "output", ((q - k + P) * (v + P)).mean(1));
      G = G + perceptron(layer + "ffn", norm(layer + "norm2", G));
    }
    out.push_back(at::softplus(perceptron("decoder.head", norm("decoder.norm", G))));
  }
  return at::cat(out);
}

}  // namespace lte::bench
