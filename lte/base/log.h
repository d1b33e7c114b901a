// Lines for people on standard error, and into --log-file where one is given. Libraries log; only
// mains print results.
#pragma once

#include <string>

#include "lte/base/check.h"

namespace lte {

enum class LogLevel { Quiet, Warning, Info };

void set_log_level(LogLevel level);
LogLevel log_level();

/// Also appends every line, whatever the level, to `path`.
/// @throws lte::Error if it cannot be opened.
void set_log_file(const std::string& path);

void log_line(LogLevel level, const std::string& line);

template <typename... Args>
void log_info(const Args&... args) {
  log_line(LogLevel::Info, concat(args...));
}

/// Printed as "warning: ...".
template <typename... Args>
void log_warning(const Args&... args) {
  log_line(LogLevel::Warning, concat(args...));
}

}  // namespace lte
