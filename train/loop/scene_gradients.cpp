#include "train/loop/scene_gradients.h"

#include <algorithm>
#include <cmath>
#include <future>

#include <ATen/Parallel.h>
#include <torch/utils.h>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/ops/bf16.h"

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
    : loss_(config.loss),
      weight_(1 / static_cast<double>(config.train.scenes_per_step)),
      device_(device),
      models_({model}) {
  const int threads = at::get_num_threads();
  if (group) {
    processes_ = group->world().size;
    reducer_ = std::make_unique<GradientReducer>(*group, model->parameters());
  }
  const bool one_by_one = !device.is_cpu() || config.model.dropout > 0 || reducer_;
  const int beside =
      one_by_one ? 1 : std::min(threads, static_cast<int>(config.train.scenes_per_step));
  threads_per_scene_ = std::max(1, threads / beside);
  for (int i = 1; i < beside; ++i) models_.push_back(replica_of(model));
  for (nn::LightTransportModel& each : models_) nn::set_autocast(*each, config.train.autocast);
  if (config.train.autocast == nn::Precision::Bf16 && device.is_cpu() && !ops::has_bf16_products())
    log_warning(
        "train.autocast: this processor has no bfloat16 products (AVX512-BF16); they are computed "
        "from float32 instructions, which is slower than none");
}

double SceneGradients::accumulate(const std::vector<Example>& examples, int64_t step) {
  const OperatorThreads scope(threads_per_scene_);
  double loss = 0;
  for (size_t begin = 0; begin < examples.size(); begin += models_.size()) {
    const size_t count = std::min(models_.size(), examples.size() - begin);
    std::vector<std::future<double>> others;
    for (size_t worker = 1; worker < count; ++worker) {
      others.push_back(std::async(std::launch::async, [&, worker] {
        at::set_num_threads(threads_per_scene_);
        return run(worker, examples[begin + worker], step);
      }));
    }
    const bool last = begin + count == examples.size();
    if (reducer_ && last) reducer_->reduce_next_backward();
    loss += weight_ * run(0, examples[begin], step);
    // In the order of the scenes, so that the sums are those of one thread.
    for (size_t worker = 1; worker < count; ++worker) {
      loss += weight_ * others[worker - 1].get();
      collect(worker);
    }
  }
  return loss;
}

double SceneGradients::run(size_t worker, const Example& stored, int64_t step) {
  nn::LightTransportModel& model = models_[worker];
  try {
    const Example example = stored.to(device_);
    // Dropout: of the example, whatever was drawn before.
    if (models_.size() == 1) torch::manual_seed(example.seed);
    const nn::Embedding embedding = model->encode(example.points, example.seed);
    const at::Tensor loss = nn::relative_loss(model->decode_normalized(embedding, example.queries),
                                              example.target, loss_, example.weight);
    const double value = loss.item<double>();
    LTE_CHECK(std::isfinite(value), "the loss is not finite (", value, ")");
    (loss * (weight_ * processes_)).backward();  // reduced to the mean over processes
    return value;
  } catch (const std::exception& error) {
    throw Error(concat("step ", step, ": scene ", stored.scene, ": ", first_line(error.what()),
                       "; no update was made, the last checkpoint stays"));
  }
}

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
