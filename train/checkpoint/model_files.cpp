#include "train/checkpoint/model_files.h"

#include <map>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "train/checkpoint/checkpoint.h"

namespace lte::train {

void save_run_model(const std::filesystem::path& path, const nn::LightTransportModel& model,
                    Optimizer* optimizer, const ModelOrigin& origin) {
  const AverageScope averaged(optimizer);
  std::map<std::string, std::string> extra = {
      {"config", origin.config},
      {"step", std::to_string(origin.step)},
      {"scene_points", std::to_string(origin.scene_points)},
      {"scene_points_pruned", origin.pruned ? "true" : "false"},
      {"suns", origin.suns ? "true" : "false"}};
  if (model->config().reads_estimates()) {
    extra["light_paths"] = std::to_string(origin.light.paths);
    extra["light_depth"] = std::to_string(origin.light.depth);
  }
  if (origin.val_loss) extra["val_loss"] = concat(*origin.val_loss);
  nn::save_model(path, model, extra);
}

void save_model_of_checkpoint(const std::filesystem::path& path,
                              const std::filesystem::path& checkpoint, const OptimConfig& config,
                              const ModelOrigin& origin) {
  const nn::LightTransportModel model(read_checkpoint_header(checkpoint).model);
  Optimizer optimizer(config, model);
  load_checkpoint(checkpoint, model, &optimizer);
  save_run_model(path, model, &optimizer, origin);
}

std::optional<int64_t> step_of_model(const std::filesystem::path& path) {
  try {
    const SafetensorsFile file(path);
    file.verify();
    return std::stoll(file.metadata("step"));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace lte::train
