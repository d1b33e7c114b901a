// lte_bake: light maps of a scene.
#include <iostream>

#include "infer/bake/bake_command.h"

int main(int argc, char** argv) {
  CLI::App app{"Bakes the light on a scene's surfaces into a texture, without a GPU.", "lte_bake"};
  app.footer(
      "Examples:\n"
      "  lte_bake room.glb --out baked                          # EXR, JSON and two GLBs\n"
      "  lte_bake room.glb --out baked --size 1024 --time 6s\n"
      "  lte_bake room.glb --out baked --by-light               # a layer a lamp\n"
      "  lte_bake room.glb --out baked --include indirect --format godot");
  lte::infer::BakeRequest request;
  lte::infer::add_bake_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] {
    if (request.tool.print_config) {
      std::cout << lte::config_text(app);
    } else {
      lte::infer::run_bake(request);
    }
  });
}
