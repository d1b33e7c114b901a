// lte_export: a model as a TorchScript module, or as a model file of half the size.
#include <cstdio>

#include "infer/export/export_command.h"

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
  infer::ExportRequest request;
  infer::add_export_options(app, &request);
  return run_tool(app, argc, argv, [&] {
    apply_common_options(request.common);
    std::fputs(infer::run_export(request).c_str(), stdout);
  });
}
