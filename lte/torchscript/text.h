// Pieces of TorchScript source put together.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>

namespace lte::torchscript {

/// Replaces every "{name}" in a template.
std::string fill(std::string text,
                 std::initializer_list<std::pair<const char*, std::string>> values);

/// A literal that reads back the same.
std::string number(double value);

/// "x" and 3: "x3".
std::string numbered(const char* prefix, size_t number);

}  // namespace lte::torchscript
