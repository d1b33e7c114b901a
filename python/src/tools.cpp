// The command-line tools, for the program `lte` of the package: their mains, compiled under other
// names (CMakeLists.txt).
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/src/module.h"

#ifdef LTE_HAS_BAKE
int lte_bake_main(int argc, char** argv);
#endif
int lte_datagen_main(int argc, char** argv);
int lte_probe_main(int argc, char** argv);
int lte_render_main(int argc, char** argv);
int lte_view_main(int argc, char** argv);

namespace lte::python {
namespace {

/// @param words  the name of the tool, then its arguments
/// @return       its exit code
int run_tool(std::vector<std::string> words) {
  constexpr std::pair<const char*, int (*)(int, char**)> kTools[] = {
#ifdef LTE_HAS_BAKE
      {"lte_bake", lte_bake_main},
#endif
      {"lte_datagen", lte_datagen_main},
      {"lte_probe", lte_probe_main},
      {"lte_render", lte_render_main},
      {"lte_view", lte_view_main}};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  for (const auto& [name, run] : kTools) {
    if (words.front() != name) continue;
    const nb::gil_scoped_release unlocked;
    return run(static_cast<int>(words.size()), arguments.data());
  }
  throw nb::value_error("no tool of this name");
}

}  // namespace

void bind_tools(nb::module_& m) { m.def("run_tool", &run_tool); }

}  // namespace lte::python
