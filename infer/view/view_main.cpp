// lte_view: a scene in the browser that one flies through and edits.
#include <iostream>

#include "infer/view/view_command.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Serves a live view of a scene to browsers: fly, dim and color lights, move objects, and "
      "the "
      "light follows.",
      "lte_view"};
  app.footer(
      "Examples:\n"
      "  lte_view room.glb\n"
      "  lte_view room.glb --port 0 --camera auto --size 960x720\n"
      "  lte_view room.glb --host 0.0.0.0 --token auto");
  lte::infer::view::ViewRequest request;
  lte::infer::view::add_view_options(app, &request);
  return lte::infer::run_network_tool(app, argc, argv, [&] {
    if (request.tool.print_config) {
      std::cout << lte::config_text(app);
    } else {
      lte::infer::view::run_view(request);
    }
  });
}
