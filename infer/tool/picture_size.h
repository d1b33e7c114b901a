// The size of a picture as flags have it: 640x480.
#pragma once

#include <string>
#include <utility>

namespace lte::infer {

/// "640x480" -> {640, 480}; {0, 0} if it is anything else, or a side is over 65,536.
std::pair<int, int> parse_picture_size(const std::string& text);

/// For CLI::Validator: what is wrong with the text, or nothing.
std::string check_picture_size(const std::string& text);

}  // namespace lte::infer
