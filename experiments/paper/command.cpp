// What the paper compares itself with or varies, on small inputs. Each subcommand serves rows of
// scripts/figures/paper.py.
#include "experiments/command.h"

#include <utility>
#include <vector>

#include "experiments/paper/commands.h"

namespace lte::experiments {

std::function<void()> add_command(CLI::App* app) {
  app->name("experiment_paper");
  app->description("What the paper compares itself with, on small inputs.");
  app->require_subcommand(1);
  std::vector<std::function<void()>> runs = {
      add_roadmap(app),    add_memory(app),   add_by_heart(app), add_deep_shading(app),
      add_hermosilla(app), add_gathered(app), add_sampling(app)};
  return [app, runs = std::move(runs)] {
    const std::vector<CLI::App*> all = app->get_subcommands([](CLI::App*) { return true; });
    for (size_t i = 0; i < all.size(); ++i) {
      if (app->got_subcommand(all[i])) runs[i]();
    }
  };
}

}  // namespace lte::experiments
