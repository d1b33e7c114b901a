#include "train/checkpoint.h"

#include <map>

#include <ATen/ops/isfinite.h>
#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/cli.h"
#include "lte/base/safetensors.h"
#include "train/tensor_io.h"

namespace lte::train {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kFormat = "lte-checkpoint";
constexpr int kVersion = 1;

std::string progress_json(const RunProgress& progress) {
  Json json = {{"step", progress.step},
               {"seed", progress.seed},
               {"seconds", progress.seconds},
               {"window_loss", progress.window_loss},
               {"window_steps", progress.window_steps},
               {"data_fingerprint", progress.data_fingerprint}};
  // JSON has no infinity: a run that was never validated has no best.
  if (progress.best_loss < std::numeric_limits<double>::infinity())
    json["best_loss"] = progress.best_loss;
  return json.dump();
}

RunProgress parse_progress(const fs::path& path, const std::string& text) {
  try {
    const Json json = Json::parse(text);
    RunProgress progress;
    progress.step = json.at("step").get<int64_t>();
    progress.seed = json.at("seed").get<uint64_t>();
    progress.seconds = json.at("seconds").get<double>();
    progress.window_loss = json.at("window_loss").get<double>();
    progress.window_steps = json.at("window_steps").get<int64_t>();
    progress.data_fingerprint = json.at("data_fingerprint").get<uint64_t>();
    progress.best_loss = json.value("best_loss", std::numeric_limits<double>::infinity());
    return progress;
  } catch (const Json::exception& error) {
    throw Error(concat(path.string(), ": metadata \"progress\" is damaged: ", error.what()));
  }
}

std::map<std::string, at::Tensor> weights_of(const nn::LightTransportModel& model) {
  std::map<std::string, at::Tensor> weights;
  for (const auto& item : model->named_parameters()) weights["model." + item.key()] = item.value();
  for (const auto& item : model->named_buffers()) weights["model." + item.key()] = item.value();
  return weights;
}

/// Header fields of an already opened file.
void check_format(const SafetensorsFile& file) {
  const std::string name = file.path().string();
  const auto format = file.metadata().find("format");
  LTE_CHECK(format != file.metadata().end() && format->second == kFormat, name,
            ": not a checkpoint of lte_train (metadata \"format\" is ",
            format == file.metadata().end() ? "missing" : "\"" + format->second + "\"", ")");
  const std::string& version = file.metadata("format_version");
  LTE_CHECK(version == std::to_string(kVersion), name, ": format_version ", version,
            " is not supported; this build reads ", kVersion, ": update lte");
}

}  // namespace

fs::path checkpoint_path(const fs::path& run) { return run / "checkpoint.safetensors"; }
fs::path model_path(const fs::path& run) { return run / "model.safetensors"; }
fs::path best_model_path(const fs::path& run) { return run / "model_best.safetensors"; }

void save_checkpoint(const fs::path& path, const nn::LightTransportModel& model,
                     const Optimizer& optimizer, const RunProgress& progress,
                     const std::string& config) {
  SafetensorsWriter writer;
  std::map<std::string, at::Tensor> storage;
  add_tensors(weights_of(model), &storage, &writer);
  add_tensors(optimizer.state(), &storage, &writer);
  writer.set_metadata("format", kFormat);
  writer.set_metadata("format_version", std::to_string(kVersion));
  writer.set_metadata("lte_version", version());
  writer.set_metadata("progress", progress_json(progress));
  writer.set_metadata("model_config", model->config().to_yaml());
  writer.set_metadata("config", config);
  writer.write(path);
}

CheckpointHeader read_checkpoint_header(const fs::path& path) {
  const SafetensorsFile file(path);
  check_format(file);
  CheckpointHeader header;
  header.progress = parse_progress(path, file.metadata("progress"));
  header.model = nn::ModelConfig::read(Config::parse(file.metadata("model_config"), path.string()));
  header.config = file.metadata("config");
  return header;
}

void load_checkpoint(const fs::path& path, const nn::LightTransportModel& model,
                     Optimizer* optimizer) {
  const torch::NoGradGuard no_grad;
  const SafetensorsFile file(path);
  check_format(file);
  for (const auto& [name, tensor] : weights_of(model)) {
    read_tensor(file, name, tensor.detach());
    LTE_CHECK(!tensor.is_floating_point() || at::isfinite(tensor).all().item<bool>(), path.string(),
              ": tensor ", name, " holds values that are not finite");
  }
  optimizer->load_state(file);
}

}  // namespace lte::train
