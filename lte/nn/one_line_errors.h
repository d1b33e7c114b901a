// LibTorch's errors, whose text carries a stack, as those of everything else.
#pragma once

#include <string>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// The first line of what a LibTorch error says.
inline std::string first_line(const c10::Error& error) {
  return lte::first_line(error.what_without_backtrace());
}

/// Runs `body`. @throws lte::Error of one line where it throws c10::Error.
template <typename Body>
auto one_line_errors(const Body& body) {
  try {
    return body();
  } catch (const c10::Error& error) {
    throw Error(first_line(error));
  }
}

}  // namespace lte::nn
