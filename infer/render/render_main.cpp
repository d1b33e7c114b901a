// lte_render: a picture of a scene.
#include <iostream>

#include "infer/render/render_command.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Renders a scene with a trained light transport embedding, or by path tracing for "
      "comparison.",
      "lte_render"};
  app.footer(
      "Examples:\n"
      "  lte_render room.glb                                   # writes room.png\n"
      "  lte_render room.glb --camera auto --size 1280x720 --out room.exr --json times.json\n"
      "  lte_render home.glb --camera all --out views/%02d_{name}.png --ev +1\n"
      "  lte_render room.glb --output irradiance --out irradiance.png\n"
      "  lte_render room.glb --mode reference --spp 256 --out reference.exr\n"
      "  lte_render room.glb --validate-only");
  lte::infer::RenderRequest request;
  lte::infer::add_render_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] {
    if (request.tool.print_config) {
      std::cout << lte::config_text(app);
    } else {
      lte::infer::run_render(request);
    }
  });
}
