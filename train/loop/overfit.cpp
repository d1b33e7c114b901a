#include "train/loop/overfit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/cli/progress.h"
#include "train/checkpoint/first_model.h"
#include "train/data/batch.h"
#include "train/loop/scene_gradients.h"
#include "train/loop/step_gradient.h"
#include "train/loop/validate.h"
#include "train/optim/optimizer.h"

namespace lte::train {
namespace {

/// How often the PSNR is looked at in the course of train.steps.
constexpr int64_t kLooks = 40;

Example first_example(const TrainConfig& config, SceneStore* store) {
  std::shared_ptr<const TrainingScene> scene;
  for (size_t i = 0; !scene; ++i) scene = store->get(i);  // throws if none is left
  Rng rng(config.seed);
  return make_example(*scene, identity_symmetry(scene->light_groups), config.data.scene_points,
                      config.data.queries_per_scene, &rng);
}

}  // namespace

OverfitResult overfit_one_scene(const TrainConfig& given, at::Device device) {
  TrainConfig config = given;
  config.model.dropout = 0;
  config.train.scenes_per_step = 1;
  RunData data = open_run_data(config);
  nn::LightTransportModel model = first_model(&config, &data);
  model->to(device);
  model->train();
  Optimizer optimizer(config.train, model);
  SceneGradients gradients(config, model, device);
  std::vector<Example> examples = {first_example(config, &data.train)};
  OverfitResult result;
  result.scene = examples[0].scene;
  result.queries = examples[0].target.size(0);
  const int64_t steps = config.train.steps, every = std::max<int64_t>(1, steps / kLooks);
  lte::Progress line("overfitting", steps, "steps");
  while (result.steps < steps && !result.reached()) {
    // Other curve orders in each step, as in training.
    examples[0].seed = hash_combine(config.seed, static_cast<uint64_t>(result.steps));
    const double norm = step_gradient(examples, result.steps, &gradients, &optimizer).norm;
    LTE_CHECK(std::isfinite(norm), "step ", result.steps + 1, ": scene ", result.scene,
              ": the gradient is not finite");
    optimizer.update(result.steps, norm);
    ++result.steps;
    line.advance();
    if (result.steps % every != 0 && result.steps != steps) continue;
    const ValidationResult now = validate(model, examples, SceneLossConfig(config), device);
    result.psnr = now.psnr;
    result.loss = now.loss;
    log_info("step ", result.steps, ": loss ", now.loss, ", PSNR ", now.psnr, " dB");
  }
  return result;
}

}  // namespace lte::train
