// Losses and gradients of the scenes of a step, `train.scenes_per_pass` of them in one pass of the
// network.
//
// On the CPU the scenes of a step run beside each other, each on its own replica of the model that
// shares the weights: the networks one trains on a CPU are narrow, and one scene to a thread keeps
// cores busy where threads inside an operator would wait for one another.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lte/nn/model.h"
#include "train/config.h"
#include "train/data/example.h"
#include "train/distributed/process_group.h"
#include "train/loop/scene_loss.h"

namespace lte::train {

class SceneGradients {
 public:
  /// Takes at::get_num_threads() threads: one for each scene as far as there are scenes, and those
  /// left over work inside operators. On a GPU, in a run of several processes, and with dropout,
  /// whose random numbers come from one global generator, the scenes run one after another.
  /// @param model  its parameters must keep their storage, which the replicas read
  /// @param group  of a run of several processes, each with a share of a step's scenes; null: this
  /// process has them all
  SceneGradients(const TrainConfig& config, const nn::LightTransportModel& model, at::Device device,
                 ProcessGroup* group = nullptr);

  /// Adds the gradient of the mean loss over `examples`, of all processes together, to the model's
  /// parameters. Its bits do not depend on how many scenes run beside each other.
  /// @param step  in the messages, counted from 1
  /// @return the mean loss; in a run of several processes this one's share of it
  /// @throws lte::Error naming step and scene if the network refuses it or the loss is not finite
  double accumulate(const std::vector<Example>& examples, int64_t step);
  /// Adds the gradient of one scene by itself, in this process alone. @return its loss
  double accumulate_alone(const Example& example, int64_t step) {
    return run(0, {&example, 1}, step);
  }

 private:
  /// One pass. @return the sum of its scenes' losses
  double run(size_t worker, std::span<const Example> scenes, int64_t step);
  void collect(size_t worker);

  SceneLossConfig loss_;
  double weight_;    ///< of a scene in the mean
  size_t pass_ = 1;  ///< scenes of a pass
  bool trains_encoder_ = true;
  int processes_ = 1;
  at::Device device_;
  int threads_per_scene_ = 1;
  std::vector<nn::LightTransportModel> models_;  ///< the model itself, then its replicas
  std::unique_ptr<GradientReducer> reducer_;     ///< null where this process is alone
};

}  // namespace lte::train
