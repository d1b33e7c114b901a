#include "infer/render/help_groups.h"

#include <vector>

namespace lte::infer {
namespace {

struct Group {
  const char* name;
  std::vector<const char*> flags;
};

std::vector<Group> groups() {
  return {{"Picture", {"--out", "--size", "--output", "--validate-only"}},
          {"Cameras and sequences", {"--camera", "--turntable", "--edit", "--resume"}},
          {"Light", {"--integrator", "--quality", "--time", "--spp", "--seed", "--set"}},
          {"The network", {"--checkpoint", "--embedding", "--save-embedding"}},
          {"The scene", {"--up", "--environment", "--add-light", "--allow-outside", "--limits"}}};
}

}  // namespace

void group_render_flags(CLI::App* app) {
  for (const auto& [group, names] : groups()) {
    for (const char* name : names) {
      CLI::Option* const option = app->get_option_no_throw(name);
      if (option != nullptr) option->group(group);
    }
  }
}

}  // namespace lte::infer
