// What a refusal says.
#pragma once

#include <exception>
#include <string>

namespace lte::test {

/// The message of the exception that a call throws; "" if it throws none.
template <typename Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace lte::test
