#include "infer/tool/picture_size.h"

#include "lte/base/check.h"
#include "lte/base/to_number.h"

namespace lte::infer {
namespace {

constexpr int kLargestSide = 65'536;

}  // namespace

std::pair<int, int> parse_picture_size(const std::string& text) {
  const auto fits = [](int side) { return side > 0 && side <= kLargestSide; };
  const auto size = to_numbers<int, 2>(text, 'x');
  if (!size || !fits((*size)[0]) || !fits((*size)[1])) return {0, 0};
  return {(*size)[0], (*size)[1]};
}

std::string check_picture_size(const std::string& text) {
  if (parse_picture_size(text).first > 0) return "";
  return concat("\"", text, "\" is no size: expected WIDTHxHEIGHT, both from 1 to ", kLargestSide);
}

}  // namespace lte::infer
