// The parameter lists of PBRT directives: "float radius" 2 "rgb L" [1 1 1] ...
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/pbrt/source.h"

namespace lte::scene::pbrt {

struct Parameter {
  std::string type;  ///< as pbrt-v4 spells it; v3's "color", "point" ... are renamed while parsing
  std::string name;
  Location at;
  std::vector<double> numbers;
  std::vector<std::string> strings;  ///< also "true" and "false" of a bool

  bool is_texture() const { return type == "texture"; }
};

using ParameterList = std::vector<Parameter>;

/// The parameters of one directive, and behind them the defaults that Attribute directives gave.
/// Every getter throws lte::Error with file and line if the parameter has another type or another
/// number of values than asked for.
class Params {
 public:
  /// @param what  the directive for messages: Shape "sphere"
  Params(std::string what, const Location& at, ParameterList own,
         std::vector<std::shared_ptr<const ParameterList>> defaults = {});

  const std::string& what() const { return what_; }
  const Location& at() const { return at_; }

  /// The parameter of that name; nullptr if there is none.
  const Parameter* find(const std::string& name) const;
  bool has(const std::string& name) const { return find(name) != nullptr; }

  double number(const std::string& name, double fallback) const;  ///< finite as a float, too
  int integer(const std::string& name, int fallback) const;
  bool boolean(const std::string& name, bool fallback) const;
  std::string text(const std::string& name, const std::string& fallback) const;
  Vec3 point(const std::string& name, const Vec3& fallback) const;
  std::vector<float> numbers(const std::string& name) const;
  std::vector<Vec3> points(const std::string& name) const;   ///< points, vectors or normals
  std::vector<Vec2> points2(const std::string& name) const;  ///< point2 or plain floats
  /// @throws lte::Error for an index that is negative or >= `vertices`.
  std::vector<uint32_t> indices(const std::string& name, size_t vertices) const;

  /// The directive's own parameters that no getter asked for; find() counts as asking.
  std::vector<const Parameter*> unused() const;

 private:
  const Parameter* typed(const std::string& name, const std::vector<std::string>& types) const;
  const Parameter* single(const std::string& name, const std::vector<std::string>& types) const;

  std::string what_;
  Location at_;
  ParameterList own_;
  std::vector<std::shared_ptr<const ParameterList>> defaults_;
  mutable std::vector<bool> used_;
};

/// Converts a number to float.
/// @throws lte::Error naming the parameter if it is not finite.
float finite_float(const Parameter& parameter, double value);

}  // namespace lte::scene::pbrt
