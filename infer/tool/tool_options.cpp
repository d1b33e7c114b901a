#include "infer/tool/tool_options.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "infer/tool/memory.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/runtime/device.h"
#include "lte/runtime/limit_error.h"

namespace lte::infer {
namespace {

using runtime::Hint;

constexpr std::pair<Hint, const char*> kFlags[] = {
    {Hint::Rescale, "--rescale"},        {Hint::FewerScenePoints, "--scene-points"},
    {Hint::FewerQueries, "--size"},      {Hint::FewerQueries, "--queries"},
    {Hint::MemoryLimit, "--max-memory"},
};

constexpr std::pair<Hint, const char*> kKeys[] = {{Hint::Rescale, "--set rescale=on"},
                                                  {Hint::FewerScenePoints, "--set scene_points"},
                                                  {Hint::MemoryLimit, "--set max_memory"}};

/// Whether `app` or a command of it that was given has this flag.
bool has_flag(const CLI::App& app, const char* flag) {
  if (app.get_option_no_throw(flag) != nullptr) return true;
  const auto commands = app.get_subcommands();
  return std::any_of(commands.begin(), commands.end(),
                     [&](const CLI::App* command) { return has_flag(*command, flag); });
}

/// " (--scene-points, --max-memory)", or nothing where `app` has no flag for any of the hints.
std::string flags_for(const CLI::App& app, const std::vector<Hint>& hints) {
  std::string list;
  const auto add = [&](Hint hint, const char* flag, bool there) {
    const bool helps = std::find(hints.begin(), hints.end(), hint) != hints.end();
    if (helps && there) list += (list.empty() ? "" : ", ") + std::string(flag);
  };
  for (const auto& [hint, flag] : kFlags) add(hint, flag, has_flag(app, flag));
  for (const auto& [hint, key] : kKeys) add(hint, key, has_flag(app, "--set"));
  return list.empty() ? "" : " (" + list + ")";
}

}  // namespace

void add_network_options(CLI::App& app, std::string* precision, double* max_memory_mb) {
  const char* group = "Common options";
  app.add_option(
         "--precision", *precision,
         "Arithmetic of the network: fp32, or bf16, which is faster where the processor has "
         "bfloat16 products, with sums in fp32")
      ->check(CLI::IsMember({"fp32", "bf16"}))
      ->capture_default_str()
      ->group(group);
  const auto check = [](const std::string& text) {
    try {
      parse_memory(text);
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  app.add_option_function<std::string>(
         "--max-memory",
         [max_memory_mb](const std::string& text) { *max_memory_mb = parse_memory(text); },
         "What the run may take above scene and model, such as 500M or 2G (plain numbers are MiB): "
         "fewer queries are decoded at a time, and what cannot fit is refused; 0 for no limit")
      ->check(CLI::Validator(check, "SIZE"))
      ->default_str("0")
      ->group(group);
}

runtime::Precision choose_precision(const std::string& word, runtime::Device device) {
  const auto precision = parse_enum<runtime::Precision>("--precision", word);
  if (precision == runtime::Precision::Bf16) runtime::warn_of_slow_bf16("--precision bf16", device);
  return precision;
}

runtime::NetworkOptions network_options(const ToolOptions& options) {
  const runtime::Device device = runtime::choose_device(options.device, "--device");
  return {device, choose_precision(options.precision, device)};
}

void add_tool_options(CLI::App& app, ToolOptions* options) {
  add_common_options(app, &options->common);
  const char* group = "Common options";
  app.add_option("--device", options->device, "cpu or cuda; by default cuda where it can be had")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->group(group);
  add_network_options(app, &options->precision, &options->max_memory_mb);
  app.add_flag("--print-config", options->print_config, "Print the settings in force and stop")
      ->configurable(false)
      ->group(group);
}

void apply_tool_options(const ToolOptions& options) {
  apply_common_options(options.common);
  runtime::set_torch_threads(options.common.threads);
}

int run_network_tool(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
  keep_freed_memory();  // pictures, as training steps, soon want again what they have freed
  return run_tool(app, argc, argv, [&] {
    try {
      body();
    } catch (const runtime::LimitError& refusal) {
      throw Error(refusal.what() + flags_for(app, refusal.hints()));
    }
  });
}

}  // namespace lte::infer
