#include "lte/torchscript/text.h"

#include <sstream>

namespace lte::torchscript {

std::string fill(std::string text,
                 std::initializer_list<std::pair<const char*, std::string>> values) {
  for (const auto& [name, value] : values) {
    const std::string mark = std::string("{") + name + "}";
    for (size_t at = text.find(mark); at != std::string::npos;
         at = text.find(mark, at + value.size())) {
      text.replace(at, mark.size(), value);
    }
  }
  return text;
}

std::string number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << std::scientific << value;
  return out.str();
}

std::string numbered(const char* prefix, size_t number) { return prefix + std::to_string(number); }

}  // namespace lte::torchscript
