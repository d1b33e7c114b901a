// What a number on the command line must be, whichever flag takes it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace lte {

/// Lets every flag of `app` and of its commands that takes numbers refuse, in one short line, what
/// CLI11 would turn into another number or into none: NaN, infinity, what float32 cannot hold,
/// integers beyond 64 bits and, where none is meant, a minus. run_tool() calls it.
void guard_numbers(CLI::App* app);

/// For check(): a number above 0; one of 0 or above. CLI11's own name the largest double in full.
CLI::Validator positive_number();
CLI::Validator non_negative_number();

/// "0.5s" -> 0.5, "200ms" -> 0.2. @throws lte::Error for anything else.
double parse_time(const std::string& text);
/// For check(): what parse_time() reads.
CLI::Validator a_time();

}  // namespace lte
