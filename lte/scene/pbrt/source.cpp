#include "lte/scene/pbrt/source.h"

#include <cctype>

namespace lte::scene::pbrt {
namespace {

constexpr size_t kMaxLines = 1000;  // a generated file may trip over everything it says
constexpr size_t kMaxQuote = 60;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool ends_word(char c) { return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#'; }

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7f;
}

std::string hex(char c) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  return {'0', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const Location& at) {
  if (at.file == nullptr) return out << "?";
  return out << at.file->name << ":" << at.line;
}

std::string quote(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, kMaxQuote)) out += is_control(c) ? '?' : c;
  return out + (text.size() > kMaxQuote ? "...\"" : "\"");
}

void IgnoredFeatures::add(const std::string& what, const Location& at) {
  const bool outside = at.file != nullptr && at.file->outside;
  const size_t quote = outside ? what.find('"') : what.npos;
  const std::string kept = quote == what.npos ? what : what.substr(0, quote) + "...";
  auto found = entries_.find(kept);
  if (found == entries_.end()) {
    if (entries_.size() >= kMaxLines) {
      ++dropped_;
      return;
    }
    found = entries_.emplace(kept, Entry{0, at, entries_.size()}).first;
  }
  ++found->second.count;
}

std::vector<std::string> IgnoredFeatures::lines() const {
  std::vector<std::string> out(entries_.size());
  for (const auto& [what, entry] : entries_) {
    out[entry.order] = entry.count == 1
                           ? concat(what, " (", entry.first, ")")
                           : concat(what, " (", entry.count, " times, first at ", entry.first, ")");
  }
  if (dropped_ > 0) out.push_back(concat("and ", dropped_, " more"));
  return out;
}

Tokenizer::Tokenizer(const TextFile* name, std::string_view text) : name_(name), text_(text) {
  LTE_CHECK(!text.starts_with("\xff\xfe") && !text.starts_with("\xfe\xff"), name->name,
            ":1: UTF-16 text, expected UTF-8 or ASCII");
  if (text.starts_with("\xef\xbb\xbf")) place_ = 3;  // a byte order mark, which some editors leave
}

void Tokenizer::skip_blank() {
  while (place_ < text_.size()) {
    const char c = text_[place_];
    if (c == '#') {
      place_ = std::min(text_.find('\n', place_), text_.size());
    } else if (is_blank(c)) {
      if (c == '\n') ++line_;
      ++place_;
    } else {
      return;
    }
  }
}

Token Tokenizer::read_string() {
  const Location at{name_, line_};
  const size_t begin = ++place_;
  bool escaped = false;
  for (; place_ < text_.size() && text_[place_] != '"'; ++place_) {
    if (text_[place_] == '\n') fail(at, "unterminated string");
    if (is_control(text_[place_]) && text_[place_] != '\t')
      fail(at, "byte ", hex(text_[place_]), " in a string: not a text file");
    if (text_[place_] == '\\') {
      escaped = true;
      if (++place_ == text_.size()) break;
    }
  }
  if (place_ >= text_.size()) fail(at, "unterminated string, the file ends in it");
  const std::string_view raw = text_.substr(begin, place_++ - begin);
  if (!escaped) return {Token::String, raw, at};
  unescaped_.clear();
  for (size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] != '\\') {
      unescaped_ += raw[i];
      continue;
    }
    constexpr std::string_view kCodes = "bfnrt\\'\"", kValues = "\b\f\n\r\t\\'\"";
    const size_t code = kCodes.find(raw[++i]);
    if (code == kCodes.npos) fail(at, "unknown escape \\", quote(raw.substr(i, 1)), " in a string");
    unescaped_ += kValues[code];
  }
  return {Token::String, unescaped_, at};
}

Token Tokenizer::next() {
  skip_blank();
  const Location at{name_, line_};
  if (place_ >= text_.size()) return {Token::End, {}, at};
  const char c = text_[place_];
  if (c == '"') return read_string();
  if (c == '[' || c == ']')
    return {c == '[' ? Token::Open : Token::Close, text_.substr(place_++, 1), at};
  if (is_control(c)) fail(at, "byte ", hex(c), ": not a text file");
  const size_t begin = place_;
  while (place_ < text_.size() && !ends_word(text_[place_])) ++place_;
  return {Token::Word, text_.substr(begin, place_ - begin), at};
}

}  // namespace lte::scene::pbrt
