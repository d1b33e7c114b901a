// LibTorch's errors as those of this library.
#pragma once

#include <string>
#include <string_view>

#include "lte/nn/one_line_errors.h"
#include "lte/runtime/limit_error.h"
#include "lte/tensor/tensor.h"

namespace lte::runtime {

/// Runs `body`. @throws NotEnoughMemory, GpuFailure or lte::Error, of one line, where it throws
/// c10::Error: LibTorch has few types of errors, and only their words tell them apart.
template <typename Body>
auto own_errors(const Body& body) {
  try {
    return body();
  } catch (const c10::Error& error) {
    const std::string message = nn::first_line(error);
    const auto has = [&](std::string_view words) { return message.find(words) != message.npos; };
    if (has("CUDA out of memory") || has("can't allocate memory") || has("not enough memory"))
      throw NotEnoughMemory(message, {});
    if (has("CUDA error") || has("CUBLAS_STATUS")) throw GpuFailure(message);
    throw Error(message);
  }
}

}  // namespace lte::runtime
