// What a program says on standard error.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "lte/base/log.h"

namespace lte::test {

/// Standard error of `body` at a level of logging.
template <typename Body>
std::string stderr_of(LogLevel level, const Body& body) {
  set_log_level(level);
  testing::internal::CaptureStderr();
  body();
  set_log_level(LogLevel::Info);
  return testing::internal::GetCapturedStderr();
}

}  // namespace lte::test
