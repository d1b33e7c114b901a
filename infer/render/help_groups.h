// The order of lte_render's help: its flags by what they are for.
#pragma once

#include <CLI/CLI.hpp>

namespace lte::infer {

/// Puts every flag of lte_render into a group of the help. Those that no group lists stay where
/// they are.
void group_render_flags(CLI::App* app);

}  // namespace lte::infer
