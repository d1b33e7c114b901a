#include "infer/tool/picture_size.h"

#include <charconv>
#include <system_error>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

constexpr int kLargestSide = 65'536;

}  // namespace

std::pair<int, int> parse_picture_size(const std::string& text) {
  const char *at = text.data(), *end = at + text.size();
  int width = 0, height = 0;
  const auto first = std::from_chars(at, end, width);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return {0, 0};
  const auto second = std::from_chars(first.ptr + 1, end, height);
  if (second.ec != std::errc() || second.ptr != end) return {0, 0};
  const auto fits = [](int side) { return side > 0 && side <= kLargestSide; };
  return fits(width) && fits(height) ? std::pair(width, height) : std::pair(0, 0);
}

std::string check_picture_size(const std::string& text) {
  if (parse_picture_size(text).first > 0) return "";
  return concat("\"", text, "\" is no size: expected WIDTHxHEIGHT, both from 1 to ", kLargestSide);
}

}  // namespace lte::infer
