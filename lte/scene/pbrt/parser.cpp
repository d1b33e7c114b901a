#include "lte/scene/pbrt/parser.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "lte/scene/import/compressed_file.h"

namespace lte::scene::pbrt {
namespace {

enum class ValueKind { Number, String, Bool, Either };

struct TypeName {
  std::string_view name, v4;  ///< as written, and as pbrt-v4 spells it
  ValueKind kind;
};

constexpr std::array<TypeName, 19> kTypes = {{{"float", "float", ValueKind::Number},
                                              {"integer", "integer", ValueKind::Number},
                                              {"point2", "point2", ValueKind::Number},
                                              {"vector2", "vector2", ValueKind::Number},
                                              {"point3", "point3", ValueKind::Number},
                                              {"point", "point3", ValueKind::Number},
                                              {"vector3", "vector3", ValueKind::Number},
                                              {"vector", "vector3", ValueKind::Number},
                                              {"normal", "normal", ValueKind::Number},
                                              {"normal3", "normal", ValueKind::Number},
                                              {"rgb", "rgb", ValueKind::Number},
                                              {"color", "rgb", ValueKind::Number},
                                              {"xyz", "xyz", ValueKind::Number},
                                              {"blackbody", "blackbody", ValueKind::Number},
                                              {"string", "string", ValueKind::String},
                                              {"texture", "texture", ValueKind::String},
                                              {"bool", "bool", ValueKind::Bool},
                                              {"boolean", "bool", ValueKind::Bool},
                                              {"spectrum", "spectrum", ValueKind::Either}}};

const char* describe(const Token& token) {
  switch (token.kind) {
    case Token::End:
      return "the end of the file";
    case Token::Word:
      return "a word";
    case Token::String:
      return "a string";
    case Token::Open:
    case Token::Close:
      return "a bracket";
  }
  return "";
}

std::string shown(const Token& token) {
  return token.kind == Token::End ? describe(token) : quote(token.text);
}

class FileParser {
 public:
  FileParser(const TextFile* name, std::string_view text, Files* files, const Target& target)
      : tokens_(name, text), files_(files), target_(target) {}

  void run() {
    for (Token token = tokens_.next(); token.kind != Token::End; token = take()) {
      if (token.kind != Token::Word)
        fail(token.at, "expected a directive, got ", describe(token), " ", shown(token));
      const std::string directive(token.text);
      if (directive == "Include" || directive == "Import") {
        follow(directive, token.at);
        continue;
      }
      const Syntax* syntax = target_.syntax(directive);
      if (syntax == nullptr) fail(token.at, "unknown directive ", quote(directive));
      target_.execute(read_call(directive, token.at, *syntax));
    }
  }

 private:
  /// The next token, or the one that a list looked at and left.
  Token take() {
    if (!has_kept_) return tokens_.next();
    has_kept_ = false;
    return kept_;
  }
  void put_back(const Token& token) {
    kept_ = token;
    has_kept_ = true;
  }

  std::string read_string(const std::string& directive) {
    const Token token = take();
    if (token.kind != Token::String)
      fail(token.at, directive, ": expected a quoted string, got ", shown(token));
    return std::string(token.text);
  }

  /// Parses an Include or Import. Import stands in an attribute block of its own.
  void follow(const std::string& directive, const Location& at) {
    const SceneFilePtr found = files_->find(read_string(directive), at);
    const bool import = directive == "Import";
    const auto bracket = [&](const char* name) {
      Call call;
      call.directive = name;
      call.at = at;
      target_.execute(std::move(call));
    };
    const TextFile* name = files_->open(*found, at);
    const CompressedFile file(found, &files_->budget());
    files_->count_text(file.text().size(), at);
    if (import) bracket("AttributeBegin");
    FileParser(name, file.text(), files_, target_).run();
    if (import) bracket("AttributeEnd");
    files_->close();
  }

  Call read_call(const std::string& directive, const Location& at, const Syntax& syntax) {
    Call call;
    call.directive = directive;
    call.at = at;
    for (int i = 0; i < syntax.strings; ++i) call.strings.push_back(read_string(directive));
    for (int i = 0; i < syntax.optional_strings; ++i) {
      const Token token = take();
      if (token.kind == Token::String) {
        call.strings.emplace_back(token.text);
      } else {
        put_back(token);
      }
    }
    if (syntax.word) {
      const Token token = take();
      if (token.kind != Token::Word) fail(token.at, directive, ": expected a word");
      call.strings.emplace_back(token.text);
    }
    if (syntax.numbers > 0) read_numbers(syntax.numbers, &call);
    if (syntax.params) read_params(&call.params);
    return call;
  }

  void read_numbers(int count, Call* call) {
    Token token = take();
    const bool brackets = token.kind == Token::Open;
    if (brackets) token = take();
    for (int i = 0; i < count; ++i) {
      if (token.kind != Token::Word)
        fail(token.at, call->directive, " takes ", count, " numbers, got ", shown(token), " after ",
             i);
      call->numbers[static_cast<size_t>(i)] = parse_number(token);
      if (brackets || i + 1 < count) token = take();
    }
    if (brackets && token.kind != Token::Close)
      fail(token.at, call->directive, " takes ", count, " numbers, expected \"]\", got ",
           shown(token));
  }

  void read_params(ParameterList* params) {
    Token token = take();
    for (; token.kind == Token::String; token = take()) params->push_back(read_param(token));
    put_back(token);
  }

  Parameter read_param(const Token& declaration) {
    Parameter out;
    out.at = declaration.at;
    const std::string_view text = declaration.text;
    const size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    const size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    const size_t name = text.find_first_not_of(" \t", end);
    if (name == text.npos)
      fail(out.at, quote(text), ": expected the type and the name of a parameter");
    out.name = text.substr(name, text.find_first_of(" \t", name) - name);
    const TypeName* type = nullptr;
    for (const TypeName& entry : kTypes) {
      if (entry.name == text.substr(begin, end - begin)) type = &entry;
    }
    if (type == nullptr) fail(out.at, quote(text), ": unknown type of a parameter");
    out.type = type->v4;
    read_values(type->kind, &out);
    if (out.type == "integer") check_integers(out);
    return out;
  }

  void read_values(ValueKind kind, Parameter* out) {
    Token token = take();
    if (token.kind != Token::Open) {
      add_value(kind, token, out);
      return;
    }
    for (token = take(); token.kind != Token::Close; token = take()) add_value(kind, token, out);
  }

  static void add_value(ValueKind kind, const Token& token, Parameter* out) {
    if (token.kind == Token::End)
      fail(token.at, "the file ends inside the parameter ", quote(out->name));
    const bool is_bool = token.text == "true" || token.text == "false";
    if (kind == ValueKind::Bool) {
      if (!is_bool || (token.kind != Token::Word && token.kind != Token::String))
        fail(token.at, "parameter ", quote(out->name), ": expected true or false, got ",
             shown(token));
      out->strings.emplace_back(token.text);
    } else if (token.kind == Token::String) {
      if (kind == ValueKind::Number)
        fail(token.at, "parameter ", quote(out->name), " is of type ", out->type,
             ", but got the string ", shown(token));
      out->strings.emplace_back(token.text);
    } else if (token.kind == Token::Word && kind != ValueKind::String) {
      out->numbers.push_back(parse_number(token));
    } else {
      fail(token.at, "parameter ", quote(out->name), " is of type ", out->type, ", but got ",
           shown(token));
    }
    if (!out->strings.empty() && !out->numbers.empty())
      fail(token.at, "parameter ", quote(out->name), " mixes strings and numbers");
  }

  static void check_integers(const Parameter& parameter) {
    for (const double value : parameter.numbers) {
      if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int32_t>::max())
        fail(parameter.at, "parameter ", quote(parameter.name), ": ", value,
             " is no integer of 32 bits");
    }
  }

  Tokenizer tokens_;
  Files* files_;
  const Target& target_;
  Token kept_;
  bool has_kept_ = false;
};

}  // namespace

double parse_number(const Token& token) {
  std::string_view text = token.text;
  const bool plus = text.starts_with('+') && !text.starts_with("+-");
  if (plus) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (token.kind != Token::Word || error == std::errc::invalid_argument ||
      end != text.data() + text.size())
    fail(token.at, "expected a number, got ", shown(token));
  // from_chars says the same of what is too large and of what is too small.
  if (error == std::errc::result_out_of_range)
    value = std::strtod(std::string(text).c_str(), nullptr);
  if (!std::isfinite(value)) fail(token.at, quote(token.text), " is not a finite number");
  return value;
}

void parse_scene(Files* files, const Target& target) {
  const SceneFilePtr scene = files->open_scene();
  const TextFile* name = files->open(*scene, {});
  const CompressedFile file(scene, &files->budget());
  files->count_text(file.text().size(), {name, 1});
  FileParser(name, file.text(), files, target).run();
  files->close();
}

}  // namespace lte::scene::pbrt
