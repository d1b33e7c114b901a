#include "lte/nn/files/model_file.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/safetensors.h"
#include "lte/base/version.h"
#include "lte/nn/files/tensor_io.h"

namespace lte::nn {
namespace {

/// Weights of the shipped models stay below 4. One beyond this bound makes nonsense of the
/// network's answers; training under weight decay and clipping does not get there.
constexpr float kLargestWeight = 1e6f;

/// Keys that may differ between a file and the model that takes its weights: the same weights mean
/// the same under them, or are meant to be tuned further.
const std::vector<std::string> kTunable = {"dropout", "output_mean", "patch_size"};

ModelConfig read_config(const SafetensorsFile& file) {
  const std::string name = file.path().string();
  const auto& metadata = file.metadata();
  const auto format = metadata.find("format");
  LTE_CHECK(format != metadata.end() && format->second == "lte-model", name,
            ": not a model (its metadata has no format \"lte-model\")");
  check_format_version(file);
  const Config yaml = Config::parse(file.metadata("model_config"), name + ": model_config");
  ModelConfig config = ModelConfig::read(yaml);
  yaml.finish();
  return config;
}

/// One line for the largest weight beyond kLargestWeight, if there is any.
void warn_of_large_weights(const std::string& name, const LightTransportModelImpl& model) {
  std::string tensor;
  float largest = kLargestWeight;
  for (const auto& item : model.named_parameters()) {
    if (item.value().numel() == 0) continue;
    const float value = item.value().abs().max().item<float>();
    if (value <= largest) continue;
    largest = value;
    tensor = item.key();
  }
  if (!tensor.empty())
    log_warning(name, ": tensor ", tensor, " has a weight of ", largest, ", above ", kLargestWeight,
                ": the file is damaged or its training diverged");
}

void copy_weights(const SafetensorsFile& file, LightTransportModelImpl& model) {
  const std::string name = file.path().string();
  const at::NoGradGuard no_grad;
  const auto parameters = model.named_parameters();
  for (const auto& [tensor, view] : file.tensors()) {
    LTE_CHECK(parameters.contains(tensor), name, ": superfluous tensor ", tensor);
  }
  for (const auto& item : parameters) {
    const at::Tensor from = at::empty(item.value().sizes(), at::kFloat);
    read_tensor(file, item.key(), from);
    LTE_CHECK(from.isfinite().all().item<bool>(), name, ": tensor ", item.key(),
              " has a value that is not finite");
    item.value().copy_(from);
  }
  warn_of_large_weights(name, model);
}

void check_same_config(const std::string& name, const ModelConfig& file, const ModelConfig& model) {
  LTE_CHECK(file.channels == model.channels, name, ": its width is D = ", file.channels,
            " but the model's is D = ", model.channels, " (model.channels)");
  for (const auto& [key, in_file, in_model] : differences(file, model)) {
    const bool tunable = std::find(kTunable.begin(), kTunable.end(), key) != kTunable.end();
    LTE_CHECK(tunable, name, ": it has model.", key, ": ", in_file, " but the model has ",
              in_model);
  }
}

void write_model(const std::filesystem::path& path, const LightTransportModel& model,
                 const std::map<std::string, std::string>& extra, at::ScalarType type) {
  SafetensorsWriter writer;
  for (const auto& [key, value] : extra) writer.set_metadata(key, value);
  writer.set_metadata("format", "lte-model");
  writer.set_metadata("format_version", std::to_string(kModelFormatVersion));
  writer.set_metadata("model_config", model->config().to_yaml());
  writer.set_metadata("lte_version", version());
  std::map<std::string, at::Tensor> weights, storage;  // the writer borrows from the latter
  for (const auto& item : model->named_parameters())
    weights[item.key()] = item.value().detach().to(type);
  add_tensors(weights, &storage, &writer);
  writer.write(path);
}

}  // namespace

void check_format_version(const SafetensorsFile& file) {
  const std::string name = file.path().string();
  const std::string& text = file.metadata("format_version");
  int64_t version = 0;
  std::istringstream(text) >> version;
  LTE_CHECK(version >= 1, name, ": format_version \"", text, "\" is not a positive number");
  LTE_CHECK(version <= kModelFormatVersion, name, ": format version ", version,
            " is newer than this program's ", kModelFormatVersion, "; update lte");
  LTE_CHECK(version == kModelFormatVersion, name, ": format version ", version,
            " is older than this program's ", kModelFormatVersion,
            "; scripts/convert_model.py makes a new file of a model, and a new run starts from "
            "that (lte_train --init-weights)");
}

void save_model(const std::filesystem::path& path, const LightTransportModel& model,
                const std::map<std::string, std::string>& extra) {
  write_model(path, model, extra, at::kFloat);
}

void save_rounded(const std::filesystem::path& from, const std::filesystem::path& to) {
  const SafetensorsFile file(from);
  write_model(to, load_model(from), file.metadata(), at::kBFloat16);
}

LightTransportModel load_model(const std::filesystem::path& path) {
  const SafetensorsFile file(path);
  file.verify();  // before its configuration decides how large a model is made
  LightTransportModel model(read_config(file));
  copy_weights(file, *model);
  model->eval();
  return model;
}

void load_weights(const std::filesystem::path& path, LightTransportModel& model) {
  const SafetensorsFile file(path);
  file.verify();
  check_same_config(path.string(), read_config(file), model->config());
  copy_weights(file, *model);
}

}  // namespace lte::nn
