#include "lte/cli/cli.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/passive_waiting.h"
#include "lte/base/text.h"
#include "lte/base/version.h"
#include "lte/cli/numbers.h"

namespace lte {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

/// The message of an error on one line. Foreign exceptions carry more lines of no use to the user
/// (c10::Error: a backtrace), ours do not.
std::string one_line(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "out of memory";
  std::string text = error.what();
  // Messages of TorchScript begin with an empty line.
  text.erase(0, text.find_first_not_of(" \r\n"));
  if (dynamic_cast<const Error*>(&error) == nullptr) text = first_line(text);
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\r', ' ');
  return text;
}

/// Flags, or names of subcommands, that `app` and the subcommands in use would have understood.
void collect_names(const CLI::App& app, bool flags, std::vector<std::string>* names) {
  if (flags) {
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names->push_back("--" + name);
    }
  } else {
    for (const CLI::App* command : app.get_subcommands({})) names->push_back(command->get_name());
  }
  for (const CLI::App* command : app.get_subcommands()) collect_names(*command, flags, names);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// What the parser did not recognize, with the nearest right name; empty if it recognized all.
std::string unknown_arguments(const CLI::App& app) {
  const std::vector<std::string> left = app.remaining(true);
  if (left.empty()) return "";
  // A word after an unknown flag is most likely its value, so a flag is named first.
  const auto flag = std::find_if(left.begin(), left.end(),
                                 [](const std::string& word) { return word.rfind("--", 0) == 0; });
  const std::string word = flag != left.end() ? *flag : left.front();
  const bool is_flag = word.rfind('-', 0) == 0;
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> candidates;
  collect_names(app, is_flag, &candidates);
  std::erase(candidates, name);  // of another command: here it is unknown
  const bool is_command = !is_flag && !candidates.empty() && app.get_subcommands().empty();
  std::string text = is_flag      ? concat("unknown option ", name)
                     : is_command ? concat("unknown command \"", name, "\"")
                                  : concat("unexpected argument \"", word, "\"");
  const std::string nearest = is_flag || is_command ? nearest_name(name, candidates) : "";
  if (!nearest.empty()) text += concat("; did you mean ", nearest, "?");
  if (is_command && nearest.empty()) text += "; the commands are " + joined(candidates);
  return text;
}

/// Whether the first word stands where a command is expected and is none.
bool names_no_command(const CLI::App& app) {
  const std::vector<std::string> left = app.remaining(true);
  return !left.empty() && left.front().rfind('-', 0) != 0 && app.get_subcommands().empty() &&
         !app.get_subcommands({}).empty();
}

int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  // --help and --version; but help for a command that does not exist is no help.
  if (error.get_exit_code() == 0 && !names_no_command(app)) return app.exit(error);
  std::string text = unknown_arguments(app);
  if (text.empty()) text = one_line(error);
  std::cerr << app.get_name() << ": " << text << " (see " << app.get_name() << " --help)\n";
  return kWrongUsage;
}

int report_failure(const CLI::App& app, const std::string& text) {
  std::cerr << app.get_name() << ": " << text << '\n';
  return kFailed;
}

/// "0 to N" of a number of threads, in words that say where N comes from.
std::string check_threads(const std::string& text) {
  int threads = 0;
  if (!CLI::detail::lexical_cast(text, threads) || threads < 0)
    return concat("\"", text, "\" is no number of threads: expected 0 (all) to ", max_threads());
  return threads <= max_threads() ? ""
                                  : concat(threads, " is more than ", max_threads(),
                                           ", four times the processors here or 64");
}

}  // namespace

void add_common_options(CLI::App& app, CommonOptions* options, bool with_json) {
  const char* group = "Common options";
  app.add_option("--threads", options->threads, "Number of CPU threads; 0 for all")
      ->check(CLI::Validator(check_threads, concat("0 to ", max_threads())))
      ->group(group);
  app.add_flag("--quiet", options->quiet, "Show no progress and no notes, only warnings")
      ->group(group);
  app.add_option("--log-file", options->log_file, "Append every log line to this file")
      ->group(group);
  if (with_json) {
    app.add_option("--json", options->json, "Write the result for machines to this file")
        ->group(group);
  }
  if (app.get_parent() == nullptr) {
    app.set_version_flag("--version", concat(app.get_name(), " ", version()))->group(group);
  }
}

void apply_common_options(const CommonOptions& options) {
  set_num_threads(options.threads);
  set_log_level(options.quiet ? LogLevel::Warning : LogLevel::Info);
  set_log_file(options.log_file);
}

std::string config_text(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) option->capture_default_str();
  return app.config_to_str(/*default_also=*/true);
}

int run_tool(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
  install_signal_cleanup();
  guard_numbers(&app);
  try {
    app.parse(argc, argv);
    wait_passively();
    body();
    std::cout.flush();
    LTE_CHECK(std::cout && std::fflush(stdout) == 0, "cannot write to standard output");
    return 0;
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  } catch (const std::exception& error) {
    return report_failure(app, one_line(error));
  } catch (...) {
    return report_failure(app, "unknown failure");
  }
}

}  // namespace lte
