// lte_export: a model as a TorchScript module, or as a model file of half the size.
#include <cstdio>

#include "infer/export/export.h"
#include "lte/base/log.h"
#include "lte/cli/cli.h"

int main(int argc, char** argv) {
  using namespace lte;
  CLI::App app{
      "Export a model as TorchScript: encode(points), decode(embedding, queries), forward(points, "
      "queries), and of a model that predicts it radiance(embedding, queries, directions). Or, "
      "with "
      "--bf16, as a model file of half the size.",
      "lte_export"};
  app.footer(
      "Examples:\n  lte_export --out model.pt\n  lte_export --checkpoint runs/a/model.safetensors "
      "--out a.pt --portable --verify\n  lte_export --checkpoint runs/a/model.safetensors "
      "--out half.safetensors --bf16");
  infer::ExportOptions options;
  CommonOptions common;
  add_common_options(app, &common, /*with_json=*/false);
  app.add_option("--checkpoint", options.model, "Model (default: lte-hybrid)");
  app.add_option("--out", options.out, "TorchScript file, or model file, to write")->required();
  CLI::Option* portable =
      app.add_flag("--portable", options.portable,
                   "Built-in operators alone: loads in PyTorch or LibTorch without lte");
  CLI::Option* verify =
      app.add_flag("--verify", options.verify,
                   "Load the file again and compare with the native model at three sizes");
  bool bf16 = false;
  app.add_flag("--bf16", bf16,
               "Write a model file (.safetensors) with its weights rounded to bfloat16")
      ->excludes(portable)
      ->excludes(verify);
  return run_tool(app, argc, argv, [&] {
    apply_common_options(common);
    options.log_file = common.log_file;
    options.progress = [](const std::string& step) { log_info("export: ", step); };
    if (bf16) {
      infer::export_rounded(options);
      std::printf("wrote %s\n", options.out.c_str());
      return;
    }
    for (const infer::ExportCheck& check : infer::export_torchscript(options)) {
      std::printf("verified M = %lld, Q = %lld: largest deviation %.2e of the largest value",
                  static_cast<long long>(check.scene_points), static_cast<long long>(check.queries),
                  check.relative_error);
      if (check.radiance_error > 0)
        std::printf("; radiance: mean deviation %.2e of the mean", check.radiance_error);
      std::printf("\n");
    }
    std::printf("wrote %s\n", options.out.c_str());
  });
}
