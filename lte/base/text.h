// Texts for messages, tables and file names.
#pragma once

#include <string>
#include <string_view>

#include "lte/base/check.h"

namespace lte {

/// What printf would print. The compiler checks the arguments against the pattern.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* pattern, ...);

/// The text up to its first line break: messages of LibTorch go on with a backtrace.
std::string first_line(std::string_view text);

/// The text between double quotes, as it is.
std::string quote(std::string_view text);

/// The text with A to Z as a to z.
std::string lower_case(std::string_view text);

}  // namespace lte
