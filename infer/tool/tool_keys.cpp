#include "infer/tool/tool_keys.h"

#include "infer/tool/memory.h"
#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::infer {

void add_scene_keys(SetKeys* keys, SceneSource* source) {
  keys->add("environment_turn", &source->environment_turn, -360, 360,
            "degrees by which --environment is turned about +Y, counter-clockwise from above");
}

void add_network_keys(SetKeys* keys, ToolOptions* options) {
  keys->add(
      "device", "cpu|cuda",
      [options](const std::string& text) -> std::string {
        if (text != "cpu" && text != "cuda" && text != "auto") return "expected auto, cpu or cuda";
        options->device = text == "auto" ? "" : text;
        return "";
      },
      [options] { return options->device.empty() ? std::string("auto") : options->device; },
      "where the network runs; auto: cuda where it can be had");
  keys->add("precision", &options->precision, {"fp32", "bf16"},
            "arithmetic of the network: bf16 is faster where the processor has bfloat16 products, "
            "with sums in fp32");
  keys->add(
      "max_memory", "SIZE",
      [options](const std::string& text) -> std::string {
        try {
          options->max_memory_mb = parse_memory(text);
          return "";
        } catch (const Error&) {
          return "expected a size such as 500M or 2G";
        }
      },
      [options] {
        return options->max_memory_mb > 0 ? formatted("%gM", options->max_memory_mb)
                                          : std::string("0");
      },
      "what the run may take above scene and model; what cannot fit is refused; 0: no limit");
}

void add_plain_tool_options(CLI::App& app, ToolOptions* options) {
  add_common_options(app, &options->common);
  app.add_flag("--print-config", options->print_config, "Print the settings in force and stop")
      ->configurable(false)
      ->group("Common options");
}

}  // namespace lte::infer
