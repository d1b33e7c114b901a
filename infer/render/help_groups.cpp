#include "infer/render/help_groups.h"

#include <vector>

namespace lte::infer {
namespace {

struct Group {
  const char* name;
  std::vector<const char*> flags;
};

std::vector<Group> groups() {
  return {{"Picture", {"--out", "--size", "--output", "--point", "--validate-only"}},
          {"Cameras and sequences",
           {"--camera", "--turntable", "--resume", "--edit", "--video", "--save-scene"}},
          {"Exposure and tone", {"--exposure", "--ev", "--tone", "--one-exposure"}},
          {"Who computes the light, and how well",
           {"--mode", "--indirect", "--quality", "--time-budget", "--denoise", "--spp",
            "--max-depth", "--check", "--metal", "--untrained-light", "--seed"}},
          {"The scene and its light",
           {"--environment", "--environment-turn", "--add-light", "--up", "--allow-outside",
            "--limits"}},
          {"The network",
           {"--checkpoint", "--scene-points", "--prune", "--draws", "--embedding",
            "--save-embedding", "--rescale", "--device", "--precision", "--max-memory"}},
          {"Fine control of one method",
           {"--direct-samples", "--adaptive-direct", "--aa", "--sparse", "--correction-paths",
            "--gather-rays", "--table-points", "--keep-light", "--reflections"}},
          {"Output attention", {"--block", "--head"}}};
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
