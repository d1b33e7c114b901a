#include "train/command/average_command.h"

#include <algorithm>
#include <map>

#include <ATen/core/grad_mode.h>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/cli/command_files.h"
#include "lte/nn/files/model_file.h"

namespace lte::train {

CLI::App* add_average_command(CLI::App& app, AverageOptions* options) {
  auto* average = app.add_subcommand(
      "average", "Write one model whose weights are the mean of those of others, of one lineage");
  average->add_option("MODEL", options->models, "Models; the first one's configuration is kept")
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size);
  average->add_option("--out", options->out, "Model file to write")->required();
  return average;
}

std::string average_models(const AverageOptions& options) {
  CommandFiles files;
  for (const std::filesystem::path& model : options.models) files.reads("MODEL", model);
  files.writes("--out", options.out);
  files.writes("--log-file", options.log_file);
  files.check();
  const at::NoGradGuard no_grad;
  const std::filesystem::path& first = options.models.front();
  nn::ModelConfig config = nn::load_model(first)->config();
  for (const std::filesystem::path& model : options.models)
    config.patch_size = std::max(config.patch_size, nn::load_model(model)->config().patch_size);
  nn::LightTransportModel sum(config);
  nn::load_weights(first, sum);
  for (size_t i = 1; i < options.models.size(); ++i) {
    nn::LightTransportModel other(config);
    nn::load_weights(options.models[i], other);
    const auto weights = other->named_parameters();
    for (auto& item : sum->named_parameters()) item.value().add_(weights[item.key()]);
  }
  const auto count = static_cast<double>(options.models.size());
  for (auto& item : sum->named_parameters()) item.value().div_(count);
  std::map<std::string, std::string> metadata = SafetensorsFile(first).metadata();
  metadata["averaged"] = std::to_string(options.models.size());
  nn::save_model(options.out, sum, metadata);
  return concat("wrote ", options.out.string(), ", the mean of ", options.models.size(),
                " models\n");
}

}  // namespace lte::train
