// Errors of everything that does not link LibTorch (which has TORCH_CHECK for the same purpose).
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace lte {

/// Bad input or a failed resource. The message is one line that says what, expected and got, and
/// names the file, key or flag; a tool's main prints it and exits with 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Streams the arguments one after another into a text.
template <typename... Args>
std::string concat(const Args&... args) {
  std::ostringstream out;
  (out << ... << args);
  return out.str();
}

}  // namespace lte

/// Throws lte::Error with the concatenated arguments unless `condition` holds.
#define LTE_CHECK(condition, ...)                                     \
  do {                                                                \
    if (!(condition)) throw ::lte::Error(::lte::concat(__VA_ARGS__)); \
  } while (false)
