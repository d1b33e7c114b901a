#include "train/checkpoint/checkpoint.h"

#include <algorithm>
#include <map>

#include <ATen/ops/empty.h>
#include <ATen/ops/isfinite.h>
#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/base/version.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/files/tensor_io.h"

namespace lte::train {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kFormat = "lte-checkpoint";
constexpr const char* kLog = "log";

std::string progress_json(const RunProgress& progress) {
  Json json = {{"step", progress.step},
               {"seed", progress.seed},
               {"best_step", progress.best_step},
               {"seconds", progress.seconds},
               {"window_loss", progress.window_loss},
               {"window_steps", progress.window_steps},
               {"light_paths", progress.light.paths},
               {"light_depth", progress.light.depth},
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
    progress.best_step = json.value("best_step", int64_t{-1});
    progress.light.paths = json.at("light_paths").get<int>();
    progress.light.depth = json.at("light_depth").get<int>();
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

void check_is_checkpoint(const SafetensorsFile& file) {
  const auto format = file.metadata().find("format");
  LTE_CHECK(format != file.metadata().end() && format->second == kFormat, file.path().string(),
            ": not a checkpoint of lte_train (metadata \"format\" is ",
            format == file.metadata().end() ? "missing" : "\"" + format->second + "\"", ")");
}

void check_format(const SafetensorsFile& file) {
  check_is_checkpoint(file);
  nn::check_format_version(file);
}

}  // namespace

fs::path checkpoint_path(const fs::path& run) { return run / "checkpoint.safetensors"; }
fs::path model_path(const fs::path& run) { return run / "model.safetensors"; }
fs::path best_model_path(const fs::path& run) { return run / "model_best.safetensors"; }
fs::path start_path(const fs::path& run) { return run / "start.safetensors"; }

void save_checkpoint(const fs::path& path, const nn::LightTransportModel& model,
                     const Optimizer& optimizer, const RunProgress& progress,
                     const std::string& config, const std::string& log) {
  SafetensorsWriter writer;
  std::map<std::string, at::Tensor> storage;
  nn::add_tensors(weights_of(model), &storage, &writer);
  nn::add_tensors(optimizer.state(), &storage, &writer);
  const at::Tensor bytes = at::empty({static_cast<int64_t>(log.size())}, at::kByte);
  std::copy(log.begin(), log.end(), bytes.data_ptr<uint8_t>());
  nn::add_tensors({{kLog, bytes}}, &storage, &writer);
  writer.set_metadata("format", kFormat);
  writer.set_metadata("format_version", std::to_string(nn::kModelFormatVersion));
  writer.set_metadata("lte_version", version());
  writer.set_metadata("progress", progress_json(progress));
  writer.set_metadata("model_config", model->config().to_yaml());
  writer.set_metadata("config", config);
  writer.write(path);
}

std::optional<std::string> checkpoint_damage(const fs::path& path) {
  std::optional<SafetensorsFile> file;
  try {
    file.emplace(path);
    check_is_checkpoint(*file);
  } catch (const Error& error) {
    return error.what();
  }
  nn::check_format_version(*file);
  try {
    file->verify();
    parse_progress(path, file->metadata("progress"));
  } catch (const Error& error) {
    return error.what();
  }
  return std::nullopt;
}

CheckpointHeader read_checkpoint_header(const fs::path& path) {
  const SafetensorsFile file(path);
  check_format(file);
  CheckpointHeader header;
  header.progress = parse_progress(path, file.metadata("progress"));
  header.model = nn::ModelConfig::read(Config::parse(file.metadata("model_config"), path.string()));
  header.config = file.metadata("config");
  if (file.contains(kLog)) {
    const auto bytes = file.values<uint8_t>(kLog, {-1});
    header.log.emplace(bytes.begin(), bytes.end());
  }
  return header;
}

void load_checkpoint(const fs::path& path, const nn::LightTransportModel& model,
                     Optimizer* optimizer) {
  const torch::NoGradGuard no_grad;
  const SafetensorsFile file(path);
  check_format(file);
  for (const auto& [name, tensor] : weights_of(model)) {
    nn::read_tensor(file, name, tensor.detach());
    LTE_CHECK(!tensor.is_floating_point() || at::isfinite(tensor).all().item<bool>(), path.string(),
              ": tensor ", name, " holds values that are not finite");
  }
  optimizer->load_state(file);
}

}  // namespace lte::train
