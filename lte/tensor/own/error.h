// Errors under LibTorch's names.
#pragma once

#include <string>

#include "lte/base/check.h"

namespace lte::tensor {

class Error : public lte::Error {
 public:
  using lte::Error::Error;
  const char* what_without_backtrace() const { return what(); }
};

template <typename... Args>
std::string str(const Args&... args) {
  return concat(args...);
}

}  // namespace lte::tensor

/// Throws c10::Error with the concatenated arguments unless `condition` holds.
#define TORCH_CHECK(condition, ...)                                           \
  do {                                                                        \
    if (!(condition)) throw ::lte::tensor::Error(::lte::concat(__VA_ARGS__)); \
  } while (false)
#define TORCH_CHECK_INDEX TORCH_CHECK
