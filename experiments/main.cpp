#include "experiments/command.h"
#include "infer/tool/tool_options.h"

int main(int argc, char** argv) {
  CLI::App app;
  const std::function<void()> run = lte::experiments::add_command(&app);
  return lte::infer::run_network_tool(app, argc, argv, run);
}
