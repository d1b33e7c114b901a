// The command of one subject's program; each subject defines its own.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace lte::experiments {

/// Gives the program its name, description and options.
/// @return  runs it with what was given, which it keeps; it may throw lte::Error
std::function<void()> add_command(CLI::App* app);

}  // namespace lte::experiments
