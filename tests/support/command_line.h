// A tool in this process: its flags as it declares them, run_tool(), and what it prints.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/cli/cli.h"

namespace lte::test {

struct CommandOutcome {
  int code = -1;
  std::string out, err;
};

/// Runs `body` behind the command line of `app`.
inline CommandOutcome run_command(
    CLI::App& app, std::vector<std::string> arguments, const std::function<void()>& body = [] {}) {
  arguments.insert(arguments.begin(), app.get_name());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  CommandOutcome outcome;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  outcome.code = run_tool(app, static_cast<int>(argv.size()), argv.data(), body);
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

/// Expects one line on standard error that has each of `parts`, and nothing else.
inline void expect_one_line(const CommandOutcome& outcome, int code,
                            const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.code, code) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : parts) EXPECT_THAT(outcome.err, testing::HasSubstr(part));
}

/// A flag that takes numbers, with the commands before it.
struct NumberFlag {
  std::vector<std::string> commands;
  std::string name, type;
};

inline void collect_number_flags(const CLI::App& app, const std::vector<std::string>& commands,
                                 std::vector<NumberFlag>* flags) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    const bool numeric =
        type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT");
    if (numeric && !option->get_lnames().empty())
      flags->push_back({commands, "--" + option->get_lnames().front(), type});
  }
  for (const CLI::App* command : app.get_subcommands({})) {
    std::vector<std::string> deeper = commands;
    deeper.push_back(command->get_name());
    collect_number_flags(*command, deeper, flags);
  }
}

/// Gives every flag of a tool that takes numbers what is none, and expects wrong usage in one short
/// line that names the flag.
/// @param declare  adds the tool's flags to an app
/// @param known    flags that have to be among those tried
inline void expect_numbers_refused(const std::function<void(CLI::App&)>& declare,
                                   const std::vector<std::string>& known) {
  const auto make = [&declare](CLI::App& app) { declare(app); };
  CLI::App listed{"", "lte_x"};
  make(listed);
  std::vector<NumberFlag> flags;
  collect_number_flags(listed, {}, &flags);
  std::vector<std::string> names;
  for (const NumberFlag& flag : flags) names.push_back(flag.name);
  for (const std::string& name : known) EXPECT_THAT(names, testing::Contains(name));
  constexpr size_t kShort = 200;
  const auto given = [&](const NumberFlag& flag, const std::string& value) {
    CLI::App app{"", "lte_x"};
    make(app);
    std::vector<std::string> arguments = flag.commands;
    arguments.push_back(flag.name + "=" + value);
    return run_command(app, arguments);
  };
  for (const NumberFlag& flag : flags) {
    std::vector<std::string> bad = {"nan",   "-nan", "inf",   "-inf",  "infinity",
                                    "1e999", "1e39", "-1e39", "12abc", "0x"};
    bad.push_back(std::string(400, '9'));
    if (flag.type.starts_with("UINT")) bad.insert(bad.end(), {"-1", "18446744073709551616"});
    if (flag.type.starts_with("INT")) bad.insert(bad.end(), {"9223372036854775808", "1.5"});
    for (const std::string& value : bad) {
      SCOPED_TRACE(flag.name + "=" + value.substr(0, 40));
      const CommandOutcome outcome = given(flag, value);
      expect_one_line(outcome, 2, {flag.name});
      EXPECT_LT(outcome.err.size(), kShort) << outcome.err;
    }
    // Out of the flag's range perhaps; then that is said briefly too.
    for (const char* value : {"-1", "0", "3e38"}) {
      const CommandOutcome outcome = given(flag, value);
      EXPECT_LT(outcome.err.size(), kShort) << outcome.err;
    }
  }
}

}  // namespace lte::test
