// lte_probe: irradiance at the points of a table.
#include <iostream>

#include "infer/probe/probe_command.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Irradiance at points of a scene's surfaces: by a trained light transport embedding, or by "
      "path tracing for comparison.",
      "lte_probe"};
  app.footer(
      "Examples:\n"
      "  lte_probe room.glb --points points.csv --out light.csv\n"
      "  lte_probe room.glb --points points.csv --out light.csv --integrator network "
      "--save-embedding room.safetensors\n"
      "  lte_probe room.glb --points more.csv --out more_light.csv --integrator network "
      "--embedding room.safetensors\n"
      "  lte_probe room.glb --points points.csv --out reference.csv --integrator path --spp 4096");
  lte::infer::ProbeRequest request;
  lte::infer::add_probe_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] {
    if (request.tool.print_config) {
      std::cout << lte::config_text(app);
    } else {
      lte::infer::run_probe(request);
    }
  });
}
