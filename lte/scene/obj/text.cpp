#include "lte/scene/obj/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "lte/base/check.h"

namespace lte::scene::obj {
namespace {

constexpr std::string_view kWhite = " \t\r\v\f";

std::string_view trim(std::string_view text) {
  const size_t begin = text.find_first_not_of(kWhite);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhite) - begin + 1);
}

}  // namespace

std::string shown(std::string_view word) {
  std::string out;
  for (const char c : word.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return word.size() > 40 ? out + "..." : out;
}

Statements::Statements(std::string_view text, std::string name)
    : text_(text), name_(std::move(name)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);     // a byte order mark
  if (text_.find('\n') == std::string_view::npos) line_end_ = '\r';  // of an old Macintosh
}

std::string_view Statements::line() {
  ++line_;
  const size_t end = text_.find(line_end_);
  std::string_view out = text_.substr(0, end);
  text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
  if (!out.empty() && out.back() == '\r') out.remove_suffix(1);
  return out;
}

bool Statements::next() {
  // A statement on one line is a view of the text; only joined lines are copied.
  while (!text_.empty()) {
    statement_ = line();
    first_line_ = line_;
    if (!statement_.empty() && statement_.back() == '\\') {
      joined_.clear();
      while (!statement_.empty() && statement_.back() == '\\') {
        joined_ += statement_.substr(0, statement_.size() - 1);
        joined_ += ' ';
        statement_ = text_.empty() ? std::string_view{} : line();
      }
      joined_ += statement_;
      statement_ = joined_;
    }
    statement_ = trim(statement_);
    if (!statement_.empty() && statement_.front() != '#') return true;
  }
  return false;
}

std::string_view Statements::word() {
  const size_t begin = statement_.find_first_not_of(kWhite);
  if (begin == std::string_view::npos) return statement_ = {};
  const size_t end = std::min(statement_.find_first_of(kWhite, begin), statement_.size());
  const std::string_view out = statement_.substr(begin, end - begin);
  statement_.remove_prefix(end);
  return out;
}

std::string_view Statements::rest() { return trim(std::exchange(statement_, {})); }

bool Statements::at_end() {
  const size_t begin = statement_.find_first_not_of(kWhite);
  return begin == std::string_view::npos || statement_[begin] == '#';
}

float Statements::number(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(concat(what, ": a number is missing"));
  const char *begin = text.data() + (text.front() == '+' ? 1 : 0), *end = text.data() + text.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  // Too small a number is as good as zero; too large a one has no place in a float.
  if (error == std::errc::result_out_of_range && stop == end &&
      (text.find("e-") != text.npos || text.find("E-") != text.npos))
    return 0;
  if (error != std::errc() || stop != end)
    fail(concat(what, ": expected a number, got \"", shown(text), "\""));
  if (!std::isfinite(static_cast<float>(value)))
    fail(concat(what, ": ", shown(text), " is not a finite float32"));
  return static_cast<float>(value);
}

std::string Statements::where() const { return concat(name_, ": line ", first_line_); }

void Statements::fail(const std::string& message) const {
  throw Error(concat(where(), ": ", message));
}

}  // namespace lte::scene::obj
