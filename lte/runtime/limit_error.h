// What the runtime cannot do, and what a caller may change about it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lte/base/check.h"

namespace lte::runtime {

/// What a caller may change so that a request succeeds. A program that has flags for it names them.
enum class Hint { Rescale, FewerScenePoints, FewerQueries, MemoryLimit };

/// A request that is well formed but cannot be met. The message states the fact and the hint in
/// the words of this library.
class LimitError : public Error {
 public:
  LimitError(const std::string& message, std::vector<Hint> hints)
      : Error(message), hints_(std::move(hints)) {}
  const std::vector<Hint>& hints() const { return hints_; }

 private:
  std::vector<Hint> hints_;
};

/// The scene is wider than the model knows, and rescaling was not asked for.
class SceneTooLarge : public LimitError {
 public:
  using LimitError::LimitError;
};

/// The machine's memory, or what a MemoryLimit leaves of it, is too little.
class NotEnoughMemory : public LimitError {
 public:
  using LimitError::LimitError;
};

/// A kernel failed, or the driver did.
class GpuFailure : public Error {
 public:
  using Error::Error;
};

}  // namespace lte::runtime
