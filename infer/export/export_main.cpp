// lte_export: a model as a TorchScript module, or as a model file of half the size.
#include <cstdio>

#include "infer/export/export_command.h"
#include "lte/base/log.h"

int main(int argc, char** argv) {
  using namespace lte;
  CLI::App app{
      "Export a model as TorchScript: encode(points), decode(embedding, queries), forward(points, "
      "queries), and of a model that predicts it radiance(embedding, queries, directions). With "
      "--bf16, write a model file of half the size instead.",
      "lte_export"};
  app.footer(
      "Examples:\n  lte_export --out model.pt\n  lte_export --checkpoint runs/a/model.safetensors "
      "--out a.pt --portable --verify\n  lte_export --checkpoint runs/a/model.safetensors "
      "--out half.safetensors --bf16");
  infer::ExportOptions options;
  CommonOptions common;
  add_common_options(app, &common, /*with_json=*/false);
  infer::add_export_options(app, &options);
  return run_tool(app, argc, argv, [&] {
    apply_common_options(common);
    options.log_file = common.log_file;
    options.progress = [](const std::string& step) { log_info("export: ", step); };
    std::fputs(infer::run_export(options).c_str(), stdout);
  });
}
