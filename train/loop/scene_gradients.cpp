#include "train/loop/scene_gradients.h"

#include <algorithm>
#include <cmath>
#include <future>

#include <ATen/Parallel.h>
#include <ATen/ops/stack.h>
#include <torch/utils.h>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/nn/device.h"

namespace lte::train {
namespace {

/// Threads of this thread's operators, put back when it ends.
class OperatorThreads {
 public:
  explicit OperatorThreads(int count) : before_(at::get_num_threads()) {
    at::set_num_threads(count);
  }
  ~OperatorThreads() { at::set_num_threads(before_); }
  OperatorThreads(const OperatorThreads&) = delete;
  OperatorThreads& operator=(const OperatorThreads&) = delete;

 private:
  int before_;
};

/// A model with the same weights, in the same memory, and with gradients of its own.
nn::LightTransportModel replica_of(const nn::LightTransportModel& model) {
  nn::LightTransportModel replica(model->config());
  const std::vector<at::Tensor> from = model->parameters(), to = replica->parameters();
  for (size_t i = 0; i < to.size(); ++i) to[i].set_data(from[i].variable_data());
  replica->train();
  return replica;
}

}  // namespace

SceneGradients::SceneGradients(const TrainConfig& config, const nn::LightTransportModel& model,
                               at::Device device, ProcessGroup* group)
    : loss_(config),
      weight_(1 / static_cast<double>(config.train.scenes_per_step)),
      pass_(static_cast<size_t>(config.train.scenes_per_pass)),
      device_(device),
      models_({model}) {
  const int threads = at::get_num_threads();
  freeze_parameters(config.train, models_.front());
  trains_encoder_ = trains_encoder(model);
  if (group) {
    processes_ = group->rank().count;
    std::vector<at::Tensor> moving = model->parameters();
    std::erase_if(moving, [](const at::Tensor& parameter) { return !parameter.requires_grad(); });
    reducer_ = std::make_unique<GradientReducer>(*group, moving);
  }
  const bool one_by_one = !device.is_cpu() || config.model.dropout > 0 || reducer_;
  const int64_t passes = (config.train.scenes_per_step + config.train.scenes_per_pass - 1) /
                         config.train.scenes_per_pass;
  const int beside = one_by_one ? 1 : std::min(threads, static_cast<int>(passes));
  threads_per_scene_ = std::max(1, threads / beside);
  for (int i = 1; i < beside; ++i)
    freeze_parameters(config.train, models_.emplace_back(replica_of(model)));
  for (nn::LightTransportModel& each : models_) nn::set_autocast(*each, config.train.autocast);
  if (config.train.autocast == nn::Precision::Bf16)
    nn::warn_of_slow_bf16("train.autocast bf16", device);
}

double SceneGradients::accumulate(const std::vector<Example>& examples, int64_t step) {
  const OperatorThreads scope(threads_per_scene_);
  std::vector<std::span<const Example>> passes;
  for (size_t begin = 0; begin < examples.size(); begin += pass_)
    passes.emplace_back(examples.data() + begin, std::min(pass_, examples.size() - begin));
  double loss = 0;
  for (size_t begin = 0; begin < passes.size(); begin += models_.size()) {
    const size_t count = std::min(models_.size(), passes.size() - begin);
    std::vector<std::future<double>> others;
    for (size_t worker = 1; worker < count; ++worker) {
      others.push_back(std::async(std::launch::async, [&, worker] {
        at::set_num_threads(threads_per_scene_);
        return run(worker, passes[begin + worker], step);
      }));
    }
    const bool last = begin + count == passes.size();
    if (reducer_ && last) reducer_->reduce_next_backward();
    loss += weight_ * run(0, passes[begin], step);
    // In the order of the scenes, so that the sums are those of one thread.
    for (size_t worker = 1; worker < count; ++worker) {
      loss += weight_ * others[worker - 1].get();
      collect(worker);
    }
  }
  return loss;
}

double SceneGradients::run(size_t worker, std::span<const Example> scenes, int64_t step) {
  nn::LightTransportModel& model = models_[worker];
  // What goes to a GPU is looked at before: there each look would wait for it.
  const auto values = device_.is_cpu() ? nn::Values::Checked : nn::Values::Unchecked;
  std::string names;
  try {
    std::vector<Example> examples;
    std::vector<nn::PointSet> points;
    std::vector<uint64_t> seeds;
    for (const Example& stored : scenes) {
      names += (names.empty() ? "" : ", ") + stored.scene;
      if (values == nn::Values::Unchecked) {
        nn::check_points(stored.points, model->config());
        nn::check_queries(stored.queries);
      }
      const Example& example = examples.emplace_back(stored.to(device_));
      points.push_back(example.points);
      seeds.push_back(example.seed);
    }
    // So dropout depends on the examples alone, whatever was drawn before.
    if (models_.size() == 1) torch::manual_seed(seeds.front());
    nn::SceneBatch batch;
    {
      const at::AutoGradMode latents(trains_encoder_);
      batch = model->encode_batch(points, seeds, values);
    }
    const std::vector<at::Tensor> losses = scene_losses(model, batch, examples, loss_, values);
    const at::Tensor each = at::stack(losses);
    (each.sum() * (weight_ * processes_)).backward();  // reduced to the mean over processes
    // Only now: a GPU goes on with the gradients while their losses are waited for.
    const at::Tensor values_of_scenes = each.detach().to(at::kCPU, at::kDouble);
    double value = 0;
    for (size_t i = 0; i < examples.size(); ++i) {
      const double loss = values_of_scenes[static_cast<int64_t>(i)].item<double>();
      names = examples[i].scene;  // whose loss it is, should it be wrong
      LTE_CHECK(std::isfinite(loss), "the loss is not finite (", loss, ")");
      value += loss;
    }
    return value;
  } catch (const std::exception& error) {
    throw Error(concat("step ", step, ": scene ", names, ": ", first_line(error.what()),
                       "; no update was made, the last checkpoint stays"));
  }
}

/// Moves the gradients of a replica to the model itself.
void SceneGradients::collect(size_t worker) {
  const torch::NoGradGuard no_grad;
  const std::vector<at::Tensor> from = models_[worker]->parameters();
  const std::vector<at::Tensor> to = models_.front()->parameters();
  for (size_t i = 0; i < to.size(); ++i) {
    at::Tensor& gradient = from[i].mutable_grad();
    if (!gradient.defined()) continue;
    at::Tensor& sum = to[i].mutable_grad();
    if (sum.defined()) {
      sum.add_(gradient);
    } else {
      sum = gradient;
    }
    gradient.reset();
  }
}

}  // namespace lte::train
