#include "infer/export/export_command.h"

#include "lte/base/text.h"

namespace lte::infer {

void add_export_options(CLI::App& app, ExportOptions* options) {
  app.add_option("--checkpoint", options->model, "Model (default: lte-hybrid)");
  app.add_option("--out", options->out, "TorchScript file, or model file, to write")->required();
  CLI::Option* portable =
      app.add_flag("--portable", options->portable,
                   "Built-in operators alone: loads in PyTorch or LibTorch without lte");
  CLI::Option* verify =
      app.add_flag("--verify", options->verify,
                   "Load the file again and compare with the native model at three sizes");
  app.add_flag("--bf16", options->bf16,
               "Write a model file (.safetensors) with its weights rounded to bfloat16")
      ->excludes(portable)
      ->excludes(verify);
}

std::string run_export(const ExportOptions& options) {
  std::string text;
  if (options.bf16) {
    export_rounded(options);
  } else {
    for (const ExportCheck& check : export_torchscript(options)) {
      text += formatted("verified M = %lld, Q = %lld: largest deviation %.2e of the largest value",
                        static_cast<long long>(check.scene_points),
                        static_cast<long long>(check.queries), check.relative_error);
      if (check.radiance_error > 0)
        text += formatted("; radiance: mean deviation %.2e of the mean", check.radiance_error);
      text += "\n";
    }
  }
  return text + "wrote " + options.out.string() + "\n";
}

}  // namespace lte::infer
