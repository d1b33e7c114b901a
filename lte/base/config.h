// Configuration: a YAML file, its `parent:` chain, and key=value overrides, read strictly.
//
// Reading marks keys as known; finish() then reports the first unknown one with the nearest known
// name. So a struct's reader is the only place that lists its keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lte/base/enum_names.h"

namespace lte {

class Config {
 public:
  /// An empty configuration: every read returns its default.
  Config();

  /// Reads `path`; a `parent:` key names a file relative to it whose keys are the defaults (maps
  /// merge, everything else replaces). Then applies `overrides`, each "a.b=value" with a YAML
  /// value.
  /// @throws lte::Error naming file and line, or the override.
  static Config load(const std::filesystem::path& path,
                     const std::vector<std::string>& overrides = {});

  /// Reads YAML text; `name` stands for the file in messages.
  static Config parse(const std::string& text, const std::string& name);

  /// The sub-map of `key`, empty if absent. It shares the bookkeeping of known keys with its
  /// parent.
  Config at(const std::string& key) const;
  bool has(const std::string& key) const;

  /// Overwrites `*value` if `key` is present, and marks it as known.
  /// @throws lte::Error naming file, full key, expected type and the text found.
  void read(const std::string& key, bool* value) const;
  void read(const std::string& key, int* value) const;
  void read(const std::string& key, int64_t* value) const;
  void read(const std::string& key, uint64_t* value) const;
  void read(const std::string& key, float* value) const;
  void read(const std::string& key, double* value) const;
  void read(const std::string& key, std::string* value) const;
  void read(const std::string& key, std::vector<int64_t>* value) const;
  void read(const std::string& key, std::vector<double>* value) const;
  void read(const std::string& key, std::vector<std::string>* value) const;

  /// A mode by its name (lte/base/enum_names.h).
  /// @throws lte::Error also for a name that is not in the table, with the names and the nearest.
  template <typename Enum, size_t N>
  void read(const std::string& key, Enum* value, const EnumNames<Enum, N>& names) const {
    std::string text = enum_name(*value, names);
    read(key, &text);
    *value = parse_enum(where(key), text, names);
  }
  template <EnumClass Enum>
  void read(const std::string& key, Enum* value) const {
    read(key, value, enum_names(Enum{}));
  }

  /// @throws lte::Error for the first key that no read() or at() asked for, with the nearest known
  /// name.
  void finish() const;

  /// The merged tree as YAML: what --print-config shows and checkpoints store.
  std::string to_yaml() const;

 private:
  struct State;
  /// "file:line: full key"; the full key alone if it is absent.
  std::string where(const std::string& key) const;

  std::shared_ptr<State> state_;
  std::string prefix_;
};

/// The candidate with the smallest edit distance to `word`, or "" if none is near.
std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace lte
