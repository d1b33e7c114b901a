// The tree behind Config, and the ways to combine trees.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lte {

/// A YAML value that remembers where it was written; merging keeps that, as yaml-cpp's nodes would
/// not.
struct ConfigTree {
  enum class Kind { Null, Scalar, List, Map };

  Kind kind = Kind::Map;
  std::string text;     ///< of a scalar
  bool quoted = false;  ///< written in quotes, so text and nothing else
  std::vector<ConfigTree> items;
  std::vector<std::pair<std::string, ConfigTree>> entries;
  std::string where;  ///< "cfg.yaml:12", or the override

  // Defined where the type is complete: clang would ask for pairs of it here.
  ConfigTree();
  ConfigTree(const ConfigTree& other);
  ConfigTree(ConfigTree&& other) noexcept;
  ConfigTree& operator=(const ConfigTree& other);
  ConfigTree& operator=(ConfigTree&& other) noexcept;
  ~ConfigTree();

  const ConfigTree* find(std::string_view key) const {
    for (const auto& [name, value] : entries) {
      if (name == key) return &value;
    }
    return nullptr;
  }
  ConfigTree& slot(const std::string& key) {
    for (auto& [name, value] : entries) {
      if (name == key) return value;
    }
    return entries.emplace_back(key, ConfigTree{}).second;
  }
};

/// How messages show a value: quoted text, or what else it is.
std::string shown(const ConfigTree& tree);

/// @throws lte::Error naming `name` and the line unless `text` is a YAML map (or empty) without
/// repeated keys.
ConfigTree parse_config_tree(const std::string& text, const std::string& name);

/// The file merged over its chain of `parent:` files.
/// @throws lte::Error naming file and line; if a parent is missing or the chain leads back to
/// itself.
ConfigTree load_config_tree(const std::filesystem::path& path);

/// Applies "a.b=value", making the maps on the way.
/// @throws lte::Error naming the override.
void apply_override(const std::string& text, ConfigTree* root);

std::string config_tree_to_yaml(const ConfigTree& root);

}  // namespace lte
