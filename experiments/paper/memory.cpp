// experiment_paper memory: the peak memory of the forward and backward pass of a training step by
// the number of primitives, weights and moments of the optimizer included, or of an answer alone:
// of our networks, and of one of RenderFormer's shape (Zeng et al. 2025). A process measures one
// row, as memory that was freed may stay with it.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/optim/adamw.h>
#include <torch/types.h>

#include "experiments/paper/commands.h"
#include "experiments/paper/roadmap_model.h"
#include "experiments/paper/trial.h"
#include "lte/base/process_memory.h"
#include "lte/nn/encoder/transformer_block.h"
#include "lte/nn/points/synthetic_room.h"

namespace lte::experiments {
namespace {

/// RenderFormer's shape by its paper: 12 layers of self-attention over triangles, and 6 of
/// cross-attention and self-attention over bundles of 8 x 8 rays, 768 channels, 6 heads. Parameters
/// of norms and encodings aside, which are small, memory follows from these.
constexpr int64_t kWidth = 768, kHeads = 6, kSceneLayers = 12, kViewLayers = 6, kBundle = 8;
constexpr int64_t kFeedForward = 4 * kWidth;
constexpr int64_t kTriangleInputs = 9 + 9 + 10;  // corners, normals, material and emission
constexpr int64_t kRayInputs = 3 * kBundle * kBundle, kRayOutputs = kRayInputs;

/// x += Attention(LN(x)), to `context` where the layer has it; x += SwiGLU(LN(x)).
class RenderFormerLayerImpl : public torch::nn::Module {
 public:
  RenderFormerLayerImpl(bool reads_context, Attention attention) {
    self_norm_ = register_module("self_norm", nn::LayerNorm(kWidth));
    self_ = register_module("self", GlobalAttention(kWidth, kHeads, attention));
    if (reads_context) {
      cross_norm_ = register_module("cross_norm", nn::LayerNorm(kWidth));
      cross_ = register_module("cross", GlobalAttention(kWidth, kHeads, attention));
    }
    norm_ = register_module("norm", nn::LayerNorm(kWidth));
    gate_ = register_module("gate", nn::Linear(kWidth, kFeedForward));
    up_ = register_module("up", nn::Linear(kWidth, kFeedForward));
    down_ = register_module("down", nn::Linear(kFeedForward, kWidth));
    for (nn::Linear* linear : {&gate_, &up_, &down_}) nn::initialize(*linear, 1);
  }

  at::Tensor forward(at::Tensor x, const at::Tensor& context) {
    if (cross_) x = x + cross_->forward(cross_norm_->forward(x), context);
    const at::Tensor normed = self_norm_->forward(x);
    x = x + self_->forward(normed, normed);
    const at::Tensor y = norm_->forward(x);
    return x + down_->forward(at::silu(gate_->forward(y)) * up_->forward(y));
  }

 private:
  nn::LayerNorm self_norm_{nullptr}, cross_norm_{nullptr}, norm_{nullptr};
  GlobalAttention self_{nullptr}, cross_{nullptr};
  nn::Linear gate_{nullptr}, up_{nullptr}, down_{nullptr};
};
TORCH_MODULE(RenderFormerLayer);

class RenderFormerShapeImpl : public torch::nn::Module {
 public:
  explicit RenderFormerShapeImpl(Attention attention) {
    triangle_ = register_module("triangle", nn::Linear(kTriangleInputs, kWidth));
    ray_ = register_module("ray", nn::Linear(kRayInputs, kWidth));
    output_ = register_module("output", nn::Linear(kWidth, kRayOutputs));
    for (int64_t i = 0; i < kSceneLayers + kViewLayers; ++i)
      layers_.push_back(register_module("layer" + std::to_string(i),
                                        RenderFormerLayer(i >= kSceneLayers, attention)));
  }

  /// @param triangles  [N, kTriangleInputs]
  /// @param rays       [bundles, kRayInputs]
  at::Tensor forward(const at::Tensor& triangles, const at::Tensor& rays) {
    at::Tensor scene = triangle_->forward(triangles);
    for (int64_t i = 0; i < kSceneLayers; ++i)
      scene = layers_[static_cast<size_t>(i)]->forward(scene, scene);
    at::Tensor view = ray_->forward(rays);
    for (int64_t i = kSceneLayers; i < kSceneLayers + kViewLayers; ++i)
      view = layers_[static_cast<size_t>(i)]->forward(view, scene);
    return output_->forward(view);
  }

 private:
  nn::Linear triangle_{nullptr}, ray_{nullptr}, output_{nullptr};
  std::vector<RenderFormerLayer> layers_;
};
TORCH_MODULE(RenderFormerShape);

struct MemoryTrial : Trial {
  std::string network = "whole", attention = "fused";
  int64_t primitives = 1024, side = 64, channels = 128;
  bool forward_only = false;
};

/// One network, and its answer to a scene of so many primitives and side² rays.
struct Measured {
  std::shared_ptr<torch::nn::Module> network;
  std::function<at::Tensor()> answer;
};

Measured renderformer(const MemoryTrial& request, Attention attention) {
  RenderFormerShape network(attention);
  const int64_t bundles = std::max<int64_t>(1, request.side / kBundle);
  const at::Tensor triangles = at::randn({request.primitives, kTriangleInputs});
  const at::Tensor rays = at::randn({bundles * bundles, kRayInputs});
  return {network.ptr(), [=]() mutable { return network->forward(triangles, rays); }};
}

Measured ours(const MemoryTrial& request, Attention attention) {
  nn::ModelConfig config;  // the paper's
  config.channels = request.channels;
  config.dropout = 0;
  RoadmapModel network(parse_enum<RoadmapNetwork>("--network", request.network), config, attention);
  network->train();
  const nn::PointSet points = nn::synthetic_room(request.primitives, 1),
                     places = nn::synthetic_room(request.side * request.side, 2);
  const nn::QuerySet queries{places.position, places.normal, places.albedo};
  return {network.ptr(), [=]() mutable { return network->forward({points}, {queries}, {1})[0]; }};
}

/// The optimizer as it is after a step, with both moments of each parameter.
std::unique_ptr<torch::optim::AdamW> with_moments(torch::nn::Module& network) {
  auto optimizer =
      std::make_unique<torch::optim::AdamW>(network.parameters(), torch::optim::AdamWOptions(1e-4));
  for (const at::Tensor& parameter : network.parameters()) {
    if (parameter.requires_grad()) parameter.mutable_grad() = at::zeros_like(parameter);
  }
  optimizer->step();
  optimizer->zero_grad();
  return optimizer;
}

void run(const MemoryTrial& request) {
  begin_trial(request);
  const Attention attention = request.attention == "stored" ? Attention::Stored : Attention::Fused;
  Measured measured = request.network == "renderformer" ? renderformer(request, attention)
                                                        : ours(request, attention);
  std::unique_ptr<torch::optim::AdamW> optimizer;  // its moments are held while it lives
  if (!request.forward_only) optimizer = with_moments(*measured.network);
  reset_peak_rss();
  const double resident = current_rss_mb();
  const std::clock_t begin = std::clock();
  if (request.forward_only) {
    const at::NoGradGuard no_grad;
    measured.answer();
  } else {
    measured.answer().square().mean().backward();
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%s, %lld primitives: %.0f MB, %.2f s\n", request.network.c_str(),
              static_cast<long long>(request.primitives), peak_rss_mb(), seconds);
  write_report(request, {{"network", request.network},
                         {"attention", request.attention},
                         {"primitives", request.primitives},
                         {"rays", request.side * request.side},
                         {"channels", request.channels},
                         {"forward_only", request.forward_only},
                         {"parameters", trained_parameters(*measured.network)},
                         {"resident_mb", resident},
                         {"peak_rss_mb", peak_rss_mb()},
                         {"cpu_seconds", seconds}});
}

void add_flags(CLI::App& command, MemoryTrial* request) {
  add_choice(command, "--network", &request->network,
             {"renderformer", "vanilla", "encoder", "whole"}, "What is measured");
  add_choice(command, "--attention", &request->attention, {"fused", "stored"},
             "Of renderformer and vanilla: fused, or stored as an N x N matrix");
  add_count(command, "--primitives", &request->primitives, 1, "Triangles, or scene points of ours");
  add_count(command, "--side", &request->side, 1, "Of the square picture whose rays are asked");
  command.add_option("--channels", request->channels, "D of ours")
      ->check(CLI::Range(32, 1024))
      ->capture_default_str();
  command.add_flag("--forward-only", request->forward_only,
                   "An answer, without gradients and the optimizer's moments");
}

}  // namespace

std::function<void()> add_memory(CLI::App* app) {
  return add_trial<MemoryTrial>(
      app, "memory", "Peak memory and time of one training step by the number of primitives",
      add_flags, run);
}

}  // namespace lte::experiments
