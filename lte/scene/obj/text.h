// The text of OBJ and MTL files: statements, and the words of one.
//
// Debian's tinyobjloader 2.0.0rc10 was tried and not taken: it reads "nan" and words as 0, and an
// index of 4294967297 as 1, without a complaint, and hands out indices past the end of its arrays.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lte::scene::obj {

/// Goes through a text statement by statement. A backslash at the end of a line joins the next one.
class Statements {
 public:
  /// @param name  of the file, for messages
  Statements(std::string_view text, std::string name);

  /// Moves to the next statement that is neither empty nor a comment; false at the end.
  bool next();

  /// The next word of the statement, empty when there are no more.
  std::string_view word();
  /// Everything that is left of the statement, without white space around it: names have spaces.
  std::string_view rest();
  bool at_end();

  /// The next word as a number.
  /// @param what  for messages: "v"
  /// @throws lte::Error naming file and line unless it is a finite number.
  float number(const char* what);

  /// File and line, for messages.
  std::string where() const;
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view line();

  std::string_view text_, statement_;
  std::string name_, joined_;
  int64_t line_ = 0, first_line_ = 0;
  char line_end_ = '\n';
};

/// The word as it may stand in a message: short, and of printable characters.
std::string shown(std::string_view word);

}  // namespace lte::scene::obj
