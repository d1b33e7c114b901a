#include "lte/scene/pbrt/params.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <utility>

namespace lte::scene::pbrt {
namespace {

std::string listed(const std::vector<std::string>& types) {
  std::string out;
  for (const std::string& type : types) out += (out.empty() ? "" : " or ") + type;
  return out;
}

const std::vector<std::string> kNumberTypes = {"float", "integer"};
const std::vector<std::string> kPointTypes = {"point3", "vector3", "normal"};

}  // namespace

float finite_float(const Parameter& parameter, double value) {
  const auto out = static_cast<float>(value);
  if (!std::isfinite(out))
    fail(parameter.at, "parameter ", quote(parameter.name), ": ", value,
         " is beyond the range of float");
  return out;
}

Params::Params(std::string what, const Location& at, ParameterList own,
               std::vector<std::shared_ptr<const ParameterList>> defaults)
    : what_(std::move(what)),
      at_(at),
      own_(std::move(own)),
      defaults_(std::move(defaults)),
      used_(own_.size()) {}

const Parameter* Params::find(const std::string& name) const {
  for (size_t i = 0; i < own_.size(); ++i) {
    if (own_[i].name != name) continue;
    used_[i] = true;
    return &own_[i];
  }
  for (auto list = defaults_.rbegin(); list != defaults_.rend(); ++list) {  // the latest one first
    for (const Parameter& parameter : **list) {
      if (parameter.name == name) return &parameter;
    }
  }
  return nullptr;
}

/// The parameter, if there is one, after a check of its type.
const Parameter* Params::typed(const std::string& name,
                               const std::vector<std::string>& types) const {
  const Parameter* parameter = find(name);
  if (parameter != nullptr && std::find(types.begin(), types.end(), parameter->type) == types.end())
    fail(parameter->at, "parameter ", quote(name), " of ", what_, " must be ", listed(types),
         ", not ", parameter->type);
  return parameter;
}

/// The parameter, if there is one, after a check that it has one value.
const Parameter* Params::single(const std::string& name,
                                const std::vector<std::string>& types) const {
  const Parameter* parameter = typed(name, types);
  if (parameter == nullptr) return nullptr;
  const size_t count = parameter->numbers.size() + parameter->strings.size();
  if (count != 1)
    fail(parameter->at, "parameter ", quote(name), " of ", what_, " takes one value, got ", count);
  return parameter;
}

double Params::number(const std::string& name, double fallback) const {
  const Parameter* parameter = single(name, kNumberTypes);
  return parameter != nullptr ? finite_float(*parameter, parameter->numbers[0]) : fallback;
}

int Params::integer(const std::string& name, int fallback) const {
  const Parameter* parameter = single(name, {"integer"});
  return parameter != nullptr ? static_cast<int>(parameter->numbers[0]) : fallback;
}

bool Params::boolean(const std::string& name, bool fallback) const {
  const Parameter* parameter = single(name, {"bool"});
  return parameter != nullptr ? parameter->strings[0] == "true" : fallback;
}

std::string Params::text(const std::string& name, const std::string& fallback) const {
  const Parameter* parameter = single(name, {"string"});
  return parameter != nullptr ? parameter->strings[0] : fallback;
}

Vec3 Params::point(const std::string& name, const Vec3& fallback) const {
  const Parameter* parameter = typed(name, kPointTypes);
  if (parameter == nullptr) return fallback;
  const std::vector<Vec3> list = points(name);
  if (list.size() != 1)
    fail(parameter->at, "parameter ", quote(name), " of ", what_, " takes one point, got ",
         list.size());
  return list[0];
}

std::vector<float> Params::numbers(const std::string& name) const {
  std::vector<float> out;
  if (const Parameter* parameter = typed(name, kNumberTypes)) {
    for (const double value : parameter->numbers) out.push_back(finite_float(*parameter, value));
  }
  return out;
}

std::vector<Vec3> Params::points(const std::string& name) const {
  std::vector<Vec3> out;
  const Parameter* parameter = typed(name, kPointTypes);
  if (parameter == nullptr) return out;
  const std::vector<double>& n = parameter->numbers;
  if (n.size() % 3 != 0)
    fail(parameter->at, "parameter ", quote(name), " of ", what_, " has ", n.size(),
         " numbers, not a multiple of 3");
  out.reserve(n.size() / 3);
  for (size_t i = 0; i < n.size(); i += 3) {
    out.push_back({finite_float(*parameter, n[i]), finite_float(*parameter, n[i + 1]),
                   finite_float(*parameter, n[i + 2])});
  }
  return out;
}

std::vector<Vec2> Params::points2(const std::string& name) const {
  std::vector<Vec2> out;
  const Parameter* parameter = typed(name, {"point2", "vector2", "float"});
  if (parameter == nullptr) return out;
  const std::vector<double>& n = parameter->numbers;
  if (n.size() % 2 != 0)
    fail(parameter->at, "parameter ", quote(name), " of ", what_, " has ", n.size(),
         " numbers, not a multiple of 2");
  out.reserve(n.size() / 2);
  for (size_t i = 0; i < n.size(); i += 2)
    out.push_back({finite_float(*parameter, n[i]), finite_float(*parameter, n[i + 1])});
  return out;
}

std::vector<uint32_t> Params::indices(const std::string& name, size_t vertices) const {
  std::vector<uint32_t> out;
  const Parameter* parameter = typed(name, {"integer"});
  if (parameter == nullptr) return out;
  out.reserve(parameter->numbers.size());
  for (const double value : parameter->numbers) {
    if (!(value >= 0 && value < static_cast<double>(vertices)))
      fail(parameter->at, "parameter ", quote(name), " of ", what_, ": index ", value,
           ", but there are ", vertices, " vertices");
    out.push_back(static_cast<uint32_t>(value));
  }
  return out;
}

std::vector<const Parameter*> Params::unused() const {
  std::vector<const Parameter*> out;
  for (size_t i = 0; i < own_.size(); ++i) {
    if (!used_[i]) out.push_back(&own_[i]);
  }
  return out;
}

}  // namespace lte::scene::pbrt
