// The boundary of the C interface: exceptions become status codes and a message of the thread.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

#include "lte/base/check.h"
#include "lte/c_api.h"

namespace lte::c_api {

/// An error whose status is known where it is found.
class ApiError : public std::runtime_error {
 public:
  ApiError(lte_status status, const std::string& message)
      : std::runtime_error(message), status_(status) {}
  lte_status status() const { return status_; }

 private:
  lte_status status_;
};

/// Throws ApiError(LTE_ERROR_INVALID_ARGUMENT) with the concatenated arguments unless `condition`.
template <typename... Args>
void require(bool condition, const Args&... args) {
  if (!condition) throw ApiError(LTE_ERROR_INVALID_ARGUMENT, concat(args...));
}

/// The text that lte_last_error() returns.
const char* last_error() noexcept;

/// Keeps the message of `error` for last_error() and returns its status.
/// @param of_ours  the status of an lte::Error of no special kind
lte_status record(const std::exception_ptr& error, lte_status of_ours) noexcept;

/// Runs `body` and returns LTE_OK, or what record() makes of its exception.
template <typename Body>
lte_status guarded(const Body& body, lte_status of_ours = LTE_ERROR_INVALID_ARGUMENT) noexcept {
  try {
    body();
    return LTE_OK;
  } catch (...) {
    return record(std::current_exception(), of_ours);
  }
}

}  // namespace lte::c_api
