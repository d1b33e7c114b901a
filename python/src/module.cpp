// The module lte._lte, which Python's side of the package, python/lte, is thin over. Arguments come
// checked from there.
#include "python/src/module.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "datagen/commands/info_command.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/version.h"
#include "lte/cli/assets.h"

#include "program/about.h"

NB_MODULE(_lte, m) {
  using namespace lte;  // NOLINT(google-build-using-namespace)
  // Scripts end with scenes in their globals.
  nanobind::set_leak_warnings(false);
  nanobind::exception<Error>(m, "Error", PyExc_RuntimeError);
  set_log_level(LogLevel::Warning);
  m.def("version", &version);
  m.def("set_threads", [](int count) { python::argument([&] { set_num_threads(count); }); });
  m.def("threads", &num_threads);
  m.def("set_verbose",
        [](bool verbose) { set_log_level(verbose ? LogLevel::Info : LogLevel::Warning); });
  python::bind_scene(m);
  python::bind_data(m);
  python::bind_picture(m);
  python::bind_light(m);
  python::bind_network(m);
#ifdef LTE_HAS_BAKE
  python::bind_bake(m);
#endif
  m.def("set_assets", [](const std::string& folder) { set_own_assets(folder); });
  m.def("about", [](const std::string& torch_program) {
    const nanobind::gil_scoped_release unlocked;
    return about({torch_program, "", ""}).dump();
  });
  m.def("describe", [](const std::string& path) {
    return python::interruptible([&] {
      SceneSource source;
      source.scene = path;
      return datagen::describe(source, false).dump();
    });
  });
  m.def("run_command", [](std::vector<std::string> words, const std::string& torch_program,
                          const std::string& torch_libraries, const std::string& torch_advice) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const nanobind::gil_scoped_release unlocked;
    return run_command(static_cast<int>(words.size()), arguments.data(),
                       {torch_program, torch_libraries, torch_advice});
  });
}
