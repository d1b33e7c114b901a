// What the runtime cannot do as asked, and what a caller may change about it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lte/base/check.h"

namespace lte::runtime {

/// What a caller may change so that a request succeeds. A program that has flags for it names them.
enum class Remedy { Rescale, FewerScenePoints, FewerQueries, MemoryLimit };

/// A request that is well formed but cannot be met. The message states the fact and the remedy in
/// the words of this library.
class Refusal : public Error {
 public:
  Refusal(const std::string& message, std::vector<Remedy> remedies)
      : Error(message), remedies_(std::move(remedies)) {}
  const std::vector<Remedy>& remedies() const { return remedies_; }

 private:
  std::vector<Remedy> remedies_;
};

/// The scene is wider than the model knows, and rescaling was not asked for.
class SceneTooLarge : public Refusal {
 public:
  using Refusal::Refusal;
};

/// The machine's memory, or what a MemoryLimit leaves of it, is too little.
class NotEnoughMemory : public Refusal {
 public:
  using Refusal::Refusal;
};

/// A kernel failed, or the driver did.
class GpuFailure : public Error {
 public:
  using Error::Error;
};

}  // namespace lte::runtime
