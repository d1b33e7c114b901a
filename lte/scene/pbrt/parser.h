// The grammar of PBRT scene files: directives, their arguments and parameter lists.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "lte/scene/pbrt/files.h"
#include "lte/scene/pbrt/params.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

/// One directive as it was read.
struct Call {
  std::string directive;
  Location at;
  std::vector<std::string> strings;
  std::array<double, 16> numbers{};
  ParameterList params;
};

/// What follows the name of a directive.
struct Syntax {
  int strings = 0;
  int optional_strings = 0;
  int numbers = 0;      ///< with or without brackets around them
  bool word = false;    ///< a bare word, which becomes a string
  bool params = false;  ///< a list of parameters
};

/// What the parser calls: `syntax` for the syntax of a directive, nullptr if it is unknown, then
/// `execute` for the directive itself. Include and Import never get there: the parser follows them,
/// and calls `execute` with "AttributeBegin" and "AttributeEnd" round an imported file.
struct Target {
  std::function<const Syntax*(const std::string& directive)> syntax;
  std::function<void(Call&& call)> execute;
};

/// Parses the scene's file and all that it includes, in order.
/// @throws lte::Error with file and line.
void parse_scene(Files* files, const Target& target);

/// Reads a number of a scene file.
/// @throws lte::Error if the token is no number, or not a finite one.
double parse_number(const Token& token);

}  // namespace lte::scene::pbrt
