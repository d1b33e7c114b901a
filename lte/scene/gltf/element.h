// A JSON object of a glTF file together with its place, so that every complaint names it.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/file.h"

namespace lte::scene::gltf {

/// A JSON object and its place in the file: what messages name.
class Element {
 public:
  Element(const File& file, const Json& json, std::string place)
      : file_(file), json_(json), place_(std::move(place)) {
    LTE_CHECK(json.is_object(), file.name, ": ", place_, " must be an object");
  }

  bool has(const char* key) const { return json_.contains(key); }
  const Json& json() const { return json_; }
  const Json& root() const { return file_.json; }

  template <typename... Args>
  void require(bool condition, const Args&... args) const {
    LTE_CHECK(condition, file_.name, ": ", place_, args...);
  }

  /// Checks that a member, if there, is a non-negative integer below 2^53.
  void natural(const char* key) const {
    if (!has(key)) return;
    const Json& value = json_[key];
    require(value.is_number_unsigned() && value.get<uint64_t>() < (uint64_t{1} << 53), ".", key,
            " must be a non-negative integer, got ", shown(value));
  }

  /// Checks as natural() does, and that the member is there.
  void needs_natural(const char* key) const {
    require(has(key), " has no ", key);
    natural(key);
  }

  /// Checks that a member, if there, is an index into the file's array `target`.
  void index(const char* key, const char* target) const {
    if (has(key)) check_index(json_[key], concat(dot(), key), target);
  }
  void needs_index(const char* key, const char* target) const {
    require(has(key), " has no ", key);
    index(key, target);
  }

  /// Checks that a member, if there, is an array of indices.
  void indices(const char* key, const char* target) const {
    if (!has(key)) return;
    require(json_[key].is_array(), ".", key, " must be an array");
    for (size_t i = 0; i < json_[key].size(); ++i)
      check_index(json_[key][i], concat(".", key, "[", i, "]"), target);
  }

  /// Checks that a member, if there, is a number. JSON has no infinities, but a double may exceed
  /// what float holds.
  void number(const char* key) const {
    if (has(key)) check_number(json_[key], concat(".", key));
  }

  /// Checks that a member, if there, is an array of `count` numbers.
  void numbers(const char* key, size_t count) const {
    if (!has(key)) return;
    const Json& value = json_[key];
    require(value.is_array() && value.size() == count, ".", key, " must be an array of ", count,
            " numbers, got ", shown(value));
    for (size_t i = 0; i < count; ++i) check_number(value[i], concat(".", key, "[", i, "]"));
  }

  void text(const char* key) const {
    if (has(key)) require(json_[key].is_string(), ".", key, " must be a string");
  }

  /// The object `key`, or an empty one.
  Element at(const char* key) const {
    static const Json kEmpty = Json::object();
    return {file_, has(key) ? json_[key] : kEmpty, concat(place_, dot(), key)};
  }

  /// Calls `check(element)` for every object of the array `key`.
  template <typename Check>
  void each(const char* key, const Check& check) const {
    if (!has(key)) return;
    require(json_[key].is_array(), dot(), key, " must be an array");
    for (size_t i = 0; i < json_[key].size(); ++i) {
      check(Element(file_, json_[key][i], concat(place_, dot(), key, "[", i, "]")));
    }
  }

  static std::string shown(const Json& value) {
    std::string out = value.dump();
    return out.size() <= 40 ? out : out.substr(0, 37) + "...";
  }

  void check_index(const Json& value, const std::string& key, const char* target) const {
    const size_t count = file_.json.contains(target) ? file_.json[target].size() : 0;
    require(value.is_number_unsigned() && value.get<uint64_t>() < count, key, " is ", shown(value),
            ", but there are ", count, " ", target);
  }

 private:
  /// Between the place and a key; the root has no name of its own.
  const char* dot() const { return place_.empty() ? "" : "."; }

  void check_number(const Json& value, const std::string& key) const {
    require(value.is_number() && std::isfinite(value.get<float>()), key,
            " must be a finite number, got ", shown(value));
  }

  const File& file_;
  const Json& json_;
  std::string place_;
};

}  // namespace lte::scene::gltf
