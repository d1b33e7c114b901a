// Only argv and the exit code live here; the subcommands are in *_command.cpp.
#include <CLI/CLI.hpp>

#include "datagen/commands/bake_command.h"
#include "datagen/commands/generate_command.h"
#include "datagen/commands/info_command.h"
#include "datagen/commands/join_command.h"
#include "datagen/commands/probe_command.h"
#include "lte/base/check.h"
#include "lte/base/version.h"
#include "lte/cli/cli.h"

int main(int argc, char** argv) {
  CLI::App app{"Makes, bakes and inspects scenes and data sets of light transport.", "lte_datagen"};
  app.set_version_flag("--version", lte::concat("lte_datagen ", lte::version()));
  app.require_subcommand(1);
  app.footer("Each command has its own --help with examples: lte_datagen generate --help");
  lte::datagen::CommandBody body;
  lte::datagen::add_generate_command(app, &body);
  lte::datagen::add_bake_command(app, &body);
  lte::datagen::add_probe_command(app, &body);
  lte::datagen::add_info_command(app, &body);
  lte::datagen::add_join_command(app, &body);
  return lte::run_tool(app, argc, argv, [&body] { body(); });
}
