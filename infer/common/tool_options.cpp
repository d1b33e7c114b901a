#include "infer/common/tool_options.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "infer/common/device.h"
#include "infer/common/memory.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/ops/bf16.h"

namespace lte::infer {

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

nn::Precision choose_precision(const std::string& word, Device device) {
  if (word == "fp32") return nn::Precision::Fp32;
  LTE_CHECK(word == "bf16", "--precision ", word, ": expected fp32 or bf16");
  if (device == Device::Cpu && !ops::has_bf16_products())
    log_warning(
        "--precision bf16: this processor has no bfloat16 products (AVX512-BF16); they are "
        "computed from float32 instructions, which is slower than fp32");
  return nn::Precision::Bf16;
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
  set_torch_threads(options.common.threads);
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
