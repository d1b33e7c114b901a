#include "infer/tool_options.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "infer/device.h"
#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::infer {

void add_tool_options(CLI::App& app, ToolOptions* options) {
  add_common_options(app, &options->common);
  const char* group = "Common options";
  app.add_option("--device", options->device, "cpu or cuda; by default cuda where it can be had")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->group(group);
  app.add_option("--max-memory", options->max_memory_mb,
                 "Stop with an error above this many MiB; 0 for no limit")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  app.add_flag("--print-config", options->print_config,
               "Print the settings in force as YAML and stop")
      ->group(group);
}

void apply_tool_options(const ToolOptions& options) {
  apply_common_options(options.common);
  set_torch_threads(options.common.threads);
}

void check_memory(const ToolOptions& options, const std::string& stage) {
  if (options.max_memory_mb <= 0) return;
  const double used = current_rss_mb();
  LTE_CHECK(used <= options.max_memory_mb, "--max-memory ", options.max_memory_mb, ": ",
            std::lround(used), " MiB are in use after ", stage);
}

void check_memory_ahead(const ToolOptions& options, double more_mb, const std::string& what) {
  if (options.max_memory_mb <= 0) return;
  const double wanted = current_rss_mb() + more_mb;
  LTE_CHECK(wanted <= options.max_memory_mb, "--max-memory ", options.max_memory_mb, ": ", what,
            " would bring it to ", std::lround(wanted), " MiB");
}

void check_writable(const std::string& path) {
  if (path.empty()) return;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  LTE_CHECK(!std::filesystem::is_directory(path), path, ": cannot be written: is a folder");
  LTE_CHECK(::access(folder.c_str(), W_OK) == 0, path,
            ": cannot be written: ", std::strerror(errno));
  LTE_CHECK(std::filesystem::is_directory(folder), path, ": cannot be written: ", folder,
            " is not a folder");
}

}  // namespace lte::infer
