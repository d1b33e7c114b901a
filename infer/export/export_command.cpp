#include "infer/export/export_command.h"

#include <filesystem>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/cli/assets.h"
#include "lte/cli/command_files.h"
#include "lte/torchscript/export.h"

namespace lte::infer {
namespace {

/// The model to read, once no file of the command is another's.
std::filesystem::path checked_model(const ExportRequest& request) {
  std::filesystem::path path = checkpoint_or_shipped(request.model);
  CommandFiles files;
  files.reads("--checkpoint", path);
  files.writes("--out", request.out);
  files.writes("--log-file", request.common.log_file);
  files.check();
  return path;
}

}  // namespace

void add_export_options(CLI::App& app, ExportRequest* request) {
  add_common_options(app, &request->common, /*with_json=*/false);
  app.add_option("--checkpoint", request->model, "Model; by default lte");
  app.add_option("--out", request->out, "TorchScript file, or model file, to write")->required();
  CLI::Option* portable =
      app.add_flag("--portable", request->portable,
                   "Built-in operators alone: loads in PyTorch or LibTorch without lte");
  CLI::Option* verify =
      app.add_flag("--verify", request->verify,
                   "Load the file again and compare with the native model at three sizes");
  app.add_flag("--bf16", request->bf16,
               "Write a model file (.safetensors) with its weights rounded to bfloat16")
      ->excludes(portable)
      ->excludes(verify);
}

std::string run_export(const ExportRequest& request) {
  const std::filesystem::path out = request.out;
  LTE_CHECK(!request.bf16 || out.extension() == ".safetensors", "--out ", request.out,
            ": --bf16 writes a model file, whose name ends in .safetensors");
  const std::filesystem::path model = checked_model(request);
  std::string text;
  if (request.bf16) {
    torchscript::export_rounded(model, out);
    return "wrote " + request.out + "\n";
  }
  std::vector<torchscript::ExportSize> sizes;
  if (request.verify) sizes = {{257, 100}, {1'024, 1'000}, {6'000, 5'000}};
  const auto progress = [](const std::string& step) { log_info("export: ", step); };
  for (const torchscript::ExportCheck& check :
       torchscript::export_torchscript({model, out, request.portable, sizes, progress})) {
    text += formatted("verified M = %lld, Q = %lld: largest deviation %.2e of the largest value",
                      static_cast<long long>(check.scene_points),
                      static_cast<long long>(check.queries), check.relative_error);
    if (check.radiance_error > 0)
      text += formatted("; radiance: mean deviation %.2e of the mean", check.radiance_error);
    text += "\n";
  }
  return text + "wrote " + request.out + "\n";
}

}  // namespace lte::infer
