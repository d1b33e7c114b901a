// The subcommands of experiment_paper, one a file.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace lte::experiments {

/// Each adds a subcommand with its options and returns what runs it, which may throw lte::Error.
std::function<void()> add_roadmap(CLI::App* app);
std::function<void()> add_memory(CLI::App* app);
std::function<void()> add_by_heart(CLI::App* app);
std::function<void()> add_deep_shading(CLI::App* app);
std::function<void()> add_hermosilla(CLI::App* app);
std::function<void()> add_gathered(CLI::App* app);
std::function<void()> add_sampling(CLI::App* app);

}  // namespace lte::experiments
