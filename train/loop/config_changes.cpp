#include "train/loop/config_changes.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/config_tree.h"
#include "lte/base/text.h"

namespace lte::train {
namespace {

using Keys = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kDefault = "its default";

std::string value_text(const ConfigTree& tree) {
  if (tree.kind == ConfigTree::Kind::Null) return "null";
  if (tree.kind == ConfigTree::Kind::Scalar) return tree.text.empty() ? "\"\"" : tree.text;
  std::string text;
  for (const ConfigTree& item : tree.items) text += (text.empty() ? "" : ", ") + value_text(item);
  return "[" + text + "]";
}

/// Every key that is no map, with the names of its maps before it.
void flatten(const ConfigTree& tree, const std::string& prefix, Keys* keys) {
  for (const auto& [name, value] : tree.entries) {
    if (value.kind == ConfigTree::Kind::Map) {
      flatten(value, prefix + name + ".", keys);
    } else {
      keys->emplace_back(prefix + name, value_text(value));
    }
  }
}

Keys flat(const std::string& yaml, const char* name) {
  Keys keys;
  flatten(parse_config_tree(yaml, name), "", &keys);
  return keys;
}

const std::string* find(const Keys& keys, const std::string& key) {
  for (const auto& [name, value] : keys) {
    if (name == key) return &value;
  }
  return nullptr;
}

bool same_number(const std::string& a, const std::string& b) {
  char *end_a = nullptr, *end_b = nullptr;
  const double first = std::strtod(a.c_str(), &end_a), second = std::strtod(b.c_str(), &end_b);
  return !a.empty() && !b.empty() && *end_a == '\0' && *end_b == '\0' && first == second;
}

bool same(const std::string& key, const std::string& a, const std::string& b) {
  if (a == b || same_number(a, b)) return true;
  std::error_code error;  // a directory has many names
  return key == "output" && std::filesystem::equivalent(a, b, error);
}

}  // namespace

std::vector<std::string> config_changes(const std::string& before, const std::string& now) {
  const Keys old = flat(before, "the run's configuration"), given = flat(now, "configuration");
  std::vector<std::string> changes;
  for (const auto& [key, value] : given) {
    const std::string* was = find(old, key);
    if (was == nullptr || !same(key, *was, value))
      changes.push_back(concat(key, ": ", was != nullptr ? *was : kDefault, " -> ", value));
  }
  for (const auto& [key, value] : old) {
    if (find(given, key) == nullptr) changes.push_back(concat(key, ": ", value, " -> ", kDefault));
  }
  return changes;
}

}  // namespace lte::train
