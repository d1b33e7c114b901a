// What loading a scene refuses although nothing of it is broken.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "lte/base/check.h"

namespace lte::scene {

/// A scene that reaches for more than LoadLimits allow. The message states the fact in the words of
/// this library; a program that has flags for them names those.
class LimitError : public Error {
 public:
  using Error::Error;
};

/// The scene names a file outside the folder of its own; LoadLimits::outside allows it.
class OutsideFolder : public LimitError {
 public:
  using LimitError::LimitError;
};

/// A cap is too low for the scene.
class OverLimit : public LimitError {
 public:
  /// @param limit   name of the cap, as parse_limits() has it
  /// @param needed  the value that would do, or 0 where reading stopped before that was known
  OverLimit(const std::string& message, std::string limit, int64_t needed = 0)
      : LimitError(message), limit_(std::move(limit)), needed_(needed) {}

  const std::string& limit() const { return limit_; }
  int64_t needed() const { return needed_; }

 private:
  std::string limit_;
  int64_t needed_;
};

/// Throws `error` anew, with `place` and a colon before its message; a refusal stays what it is.
[[noreturn]] void rethrow_at(const std::string& place, const Error& error);

}  // namespace lte::scene
