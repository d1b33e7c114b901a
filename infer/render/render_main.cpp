// lte_render: a picture of a scene.
#include <iostream>

#include "infer/render/render_command.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Renders a scene: by rays over an irradiance cache, over the light that a network knows, or "
      "by path tracing.",
      "lte_render"};
  app.footer(
      "Examples:\n"
      "  lte_render room.glb                                   # writes room.png\n"
      "  lte_render room.glb --time 2s --size 640x480 --out room.exr\n"
      "  lte_render home.glb --camera all --out views/%02d_{name}.png --set ev=+1\n"
      "  lte_render room.glb --integrator network --quality preview --out room.png\n"
      "  lte_render room.glb --integrator path --spp 1024 --set denoise=off --out reference.exr\n"
      "  lte_render room.glb --edit edits.yaml --quality draft --out frames/%04d.png\n"
      "  lte_render room.glb --turntable 96 --quality preview --out turn.mp4   # by ffmpeg");
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
