// PBRT files as text: places in them, what the importer reports about them, and their tokens.
#pragma once

#include <deque>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "lte/base/check.h"

namespace lte::scene::pbrt {

/// A file of text, interned in the Files of the import.
struct TextFile {
  std::string name;
  bool outside = false;  ///< of the scene's folder: no message may quote it
};

/// A line of a file, which lives as long as the Files of the import.
struct Location {
  const TextFile* file = nullptr;
  int line = 0;
};
/// Prints as "scene.pbrt:12".
std::ostream& operator<<(std::ostream& out, const Location& at);

/// A part of a message about a line of a file outside: words of ours, which are literals, stay; all
/// else may come from the file.
template <typename T>
std::string discreet_part(const T& part) {
  if constexpr (std::is_convertible_v<const T&, const char*>) return part;
  return "...";
}

template <typename... Args>
[[noreturn]] void fail(const Location& at, const Args&... args) {
  if (at.file != nullptr && at.file->outside) throw Error(concat(at, ": ", discreet_part(args)...));
  throw Error(concat(at, ": ", args...));
}

/// Text of a file between quotes, as a message may show it: short, on one line, printable.
std::string quote(std::string_view text);

/// What the importer leaves out or changes, with the first place of each, for Scene::ignored.
class IgnoredFeatures {
 public:
  /// @param what  e.g. "alpha of a shape"; equal texts are counted together. What a file says
  /// stands behind a quotation mark: if it lies outside the scene's folder, the text ends there.
  void add(const std::string& what, const Location& at);
  /// "alpha of a shape (scene.pbrt:12)" or "... (3 times, first at scene.pbrt:12)", in order of
  /// first appearance. Beyond 1,000 different lines the rest is only counted.
  std::vector<std::string> lines() const;

 private:
  struct Entry {
    int64_t count = 0;
    Location first;
    size_t order = 0;
  };
  std::map<std::string, Entry> entries_;
  int64_t dropped_ = 0;
};

struct Token {
  enum Kind { End, Word, String, Open, Close };
  Kind kind = End;
  std::string_view text;  ///< a string's without its quotes; valid until the next token is read
  Location at;
};

/// Splits the text of one file. Comments and white space are skipped.
class Tokenizer {
 public:
  /// @param name, text  must outlive the tokenizer
  Tokenizer(const TextFile* name, std::string_view text);

  /// @throws lte::Error for an unterminated string, an unknown escape, a byte that no text file
  /// has.
  Token next();
  Location at() const { return {name_, line_}; }

 private:
  void skip_blank();
  Token read_string();

  const TextFile* name_;
  std::string_view text_;
  size_t place_ = 0;
  int line_ = 1;
  std::string unescaped_;
};

}  // namespace lte::scene::pbrt
