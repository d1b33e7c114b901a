#include "program/commands.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "lte/base/version.h"
#include "lte/cli/assets.h"

#include "program/about.h"

// Mains of the tools (lte_add_tool). Those that a build lacks are null.
[[gnu::weak]] int lte_bake_main(int argc, char** argv);
[[gnu::weak]] int lte_bench_main(int argc, char** argv);
[[gnu::weak]] int lte_datagen_main(int argc, char** argv);
[[gnu::weak]] int lte_eval_main(int argc, char** argv);
[[gnu::weak]] int lte_export_main(int argc, char** argv);
[[gnu::weak]] int lte_probe_main(int argc, char** argv);
[[gnu::weak]] int lte_render_main(int argc, char** argv);
[[gnu::weak]] int lte_train_main(int argc, char** argv);
[[gnu::weak]] int lte_view_main(int argc, char** argv);

namespace lte {
namespace {

struct Command {
  std::string_view name, tool, about, needs;
  int (*run)(int argc, char** argv);
};

constexpr std::string_view kTorch = "LibTorch";

const Command kCommands[] = {
    {"render", "lte_render", "a picture of a scene, or a video", "Embree", lte_render_main},
    {"view", "lte_view", "fly through a scene in the browser, dim lamps, move things",
     "Embree and Boost", lte_view_main},
    {"probe", "lte_probe", "light at the points of a table", "Embree", lte_probe_main},
    {"bake", "lte_bake", "light maps and probes, without a GPU", "xatlas", lte_bake_main},
    {"data", "lte_datagen", "scenes and training data", "Embree", lte_datagen_main},
    {"train", "lte_train", "a network from data", kTorch, lte_train_main},
    {"eval", "lte_eval", "a network's error on data", "Embree", lte_eval_main},
    {"export", "lte_export", "a network as TorchScript", kTorch, lte_export_main},
    {"bench", "lte_bench", "times of every stage", kTorch, lte_bench_main},
    {"info", "lte_datagen", "what is in a scene or a data set; alone: what lte has", "Embree",
     lte_datagen_main},
    {"demo", "lte_render", "a picture of the room that comes with lte; takes render's flags",
     "Embree", lte_render_main},
};

const Command* find(std::string_view word, std::string_view Command::*member) {
  for (const Command& command : kCommands) {
    if (command.*member == word) return &command;
  }
  return nullptr;
}

bool there_is(const Command& command, const TorchTools& torch) {
  return command.run != nullptr || (command.needs == kTorch && !torch.program.empty());
}

void print_usage(std::ostream& out, const TorchTools& torch) {
  out << "usage: lte COMMAND ...; each COMMAND has --help\n";
  for (const Command& command : kCommands) {
    if (!there_is(command, torch)) continue;
    out << "  lte " << command.name << std::string(8 - command.name.size(), ' ') << command.about
        << '\n';
  }
}

/// As YAML.
void print_about(const TorchTools& torch) {
  TorchTools found = torch;
  if (lte_train_main != nullptr)
    found.program = std::filesystem::read_symlink("/proc/self/exe").string();
  const nlohmann::ordered_json facts = about(found);
  for (const auto& [key, value] : facts.items()) std::cout << key << ": " << value.dump() << '\n';
}

int run(const Command& command, std::vector<std::string> words, const TorchTools& torch) {
  if (!there_is(command, torch)) {
    const bool advised = command.needs == kTorch && !torch.advice.empty();
    std::cerr << "lte: " << command.name << " needs " << command.needs << ": "
              << (advised ? torch.advice
                          : "this package is built without; pip install lte[torch] has it, or a "
                            "build of the sources (scripts/build.sh)")
              << '\n';
    return 1;
  }
  words.insert(words.begin(), std::string(command.tool));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (command.run != nullptr) return command.run(static_cast<int>(words.size()), arguments.data());
  if (!torch.libraries.empty()) setenv("LD_LIBRARY_PATH", torch.libraries.c_str(), 1);
  if (!own_assets().empty()) setenv("LTE_ASSETS", own_assets().c_str(), 0);
  execv(torch.program.c_str(), arguments.data());  // which knows the tool by argv[0]
  std::cerr << "lte: " << torch.program << ": " << std::strerror(errno) << '\n';
  return 1;
}

/// What stands before the words of a command, and after them where there are none.
std::vector<std::string> complete(const Command& command, std::vector<std::string> words) {
  if (command.name == "info") words.insert(words.begin(), "info");
  if (command.name == "demo") {
    if (words.empty()) words = {"--quality", "preview", "--out", "lte_demo.png"};
    words.insert(words.begin(), asset_path("scenes/living_room.glb", "a scene").string());
  }
  return words;
}

}  // namespace

int run_command(int argc, char** argv, const TorchTools& torch) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const std::string called = std::filesystem::path(argv[0]).filename().string();
  if (const Command* tool = find(called, &Command::tool)) return run(*tool, words, torch);
  const std::string word = words.empty() ? "" : words.front();
  if (word == "--version") {
    std::cout << "lte " << version() << '\n';
    return 0;
  }
  if (word == "--help" || word == "-h") {
    print_usage(std::cout, torch);
    return 0;
  }
  const Command* command = find(word, &Command::name);
  if (command == nullptr) {
    if (word.empty())
      print_usage(std::cerr, torch);
    else
      std::cerr << "lte: there is no command " << word << "; lte --help lists them\n";
    return 2;
  }
  try {
    if (word == "info" && words.size() == 1) {
      print_about(torch);
      return 0;
    }
    return run(*command, complete(*command, {words.begin() + 1, words.end()}), torch);
  } catch (const std::exception& error) {  // the demo's scene is not there
    std::cerr << "lte: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace lte
