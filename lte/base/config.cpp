#include "lte/base/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/config_tree.h"
#include "lte/base/text.h"

namespace lte {
namespace {

[[noreturn]] void ill_typed(const std::string& key, const ConfigTree& tree,
                            const std::string& expected) {
  throw Error(concat(tree.where, ": ", key, ": expected ", expected, ", got ", shown(tree)));
}

template <typename T>
std::string integer_range() {
  return concat("an integer from ", std::numeric_limits<T>::min(), " to ",
                std::numeric_limits<T>::max());
}

/// The whole of a plain scalar as a number; a leading plus is YAML's, not from_chars'.
template <typename T>
std::errc parse_number(const ConfigTree& tree, T* value) {
  if (tree.kind != ConfigTree::Kind::Scalar || tree.quoted) return std::errc::invalid_argument;
  std::string_view text = tree.text;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end != text.data() + text.size() ? std::errc::invalid_argument
                                                                  : error;
}

template <typename T>
void convert_value(const std::string& key, const ConfigTree& tree, T* value) {
  T parsed{};
  const std::errc error = parse_number(tree, &parsed);
  if constexpr (std::is_integral_v<T>) {
    // For an unsigned type, from_chars calls a negative number ill-formed. It is out of range.
    int64_t negative = 0;
    const bool below = std::is_unsigned_v<T> && error != std::errc() &&
                       parse_number(tree, &negative) == std::errc();
    if (error == std::errc::result_out_of_range || below) ill_typed(key, tree, integer_range<T>());
    if (error != std::errc()) ill_typed(key, tree, "an integer");
  } else {
    if (error == std::errc::result_out_of_range || !std::isfinite(parsed))
      ill_typed(key, tree, "a finite number");
    if (error != std::errc()) ill_typed(key, tree, "a number");
  }
  *value = parsed;
}

void convert_value(const std::string& key, const ConfigTree& tree, bool* value) {
  const bool plain = tree.kind == ConfigTree::Kind::Scalar && !tree.quoted;
  if (!plain || (tree.text != "true" && tree.text != "false"))
    ill_typed(key, tree, "true or false");
  *value = tree.text == "true";
}

void convert_value(const std::string& key, const ConfigTree& tree, std::string* value) {
  if (tree.kind != ConfigTree::Kind::Scalar) ill_typed(key, tree, "a text");
  *value = tree.text;
}

template <typename T>
void convert_value(const std::string& key, const ConfigTree& tree, std::vector<T>* value) {
  if (tree.kind != ConfigTree::Kind::List) ill_typed(key, tree, "a list");
  std::vector<T> parsed(tree.items.size());
  for (size_t i = 0; i < parsed.size(); ++i)
    convert_value(concat(key, "[", i, "]"), tree.items[i], &parsed[i]);
  *value = std::move(parsed);
}

std::string last_component(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// Whether a word is short for a name of several words, or begins it: lr and learning_rate, weight
/// and weight_decay.
bool is_short_for(const std::string& word, const std::string& name) {
  std::string initials;
  for (size_t i = 0; i < name.size(); ++i)
    if (i == 0 || name[i - 1] == '_') initials += name[i];
  return word.size() >= 2 && (word == initials || name.starts_with(word));
}

/// The nearest known key; else the one known key whose last component is near: the right name in
/// the wrong map; else one that the last component is short for, in the same map if there is one.
std::string nearest_key(const std::string& key, const std::set<std::string>& known) {
  const std::vector<std::string> keys(known.begin(), known.end());
  std::string nearest = nearest_name(key, keys);
  if (!nearest.empty()) return nearest;
  std::vector<std::string> names;
  for (const std::string& name : keys) names.push_back(last_component(name));
  nearest = nearest_name(last_component(key), names);
  for (size_t i = 0; i < keys.size() && !nearest.empty(); ++i) {
    if (names[i] == nearest) return keys[i];
  }
  const std::string name = last_component(key), map = key.substr(0, key.size() - name.size());
  for (const bool same_map : {true, false}) {
    for (size_t i = 0; i < keys.size(); ++i)
      if (is_short_for(name, names[i]) && (!same_map || keys[i] == map + names[i])) return keys[i];
  }
  return "";
}

void check_known(const ConfigTree& map, const std::string& prefix,
                 const std::set<std::string>& known) {
  for (const auto& [name, value] : map.entries) {
    const std::string key = prefix + name;
    if (known.count(key) == 0) {
      const std::string nearest = nearest_key(key, known);
      throw Error(concat(value.where, ": unknown key ", quote(key),
                         nearest.empty() ? "" : "; did you mean " + quote(nearest) + "?"));
    }
    check_known(value, key + ".", known);
  }
}

/// The optimal string alignment distance: how many insertions, deletions, replacements and swaps of
/// neighbours lead from one word to the other.
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> before, previous(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) previous[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = previous;
    previous = row;
  }
  return previous[b.size()];
}

}  // namespace

struct Config::State {
  ConfigTree root;
  std::set<std::string> known;

  /// The value at a dotted key below maps; null if absent.
  const ConfigTree* find(const std::string& key) const {
    const ConfigTree* tree = &root;
    for (size_t begin = 0; begin <= key.size() && tree != nullptr;) {
      const size_t end = std::min(key.find('.', begin), key.size());
      tree = tree->find(std::string_view(key).substr(begin, end - begin));
      begin = end + 1;
    }
    return tree;
  }

  template <typename T>
  void read(const std::string& key, T* value) {
    known.insert(key);
    if (const ConfigTree* tree = find(key)) convert_value(key, *tree, value);
  }
};

Config::Config() : state_(std::make_shared<State>()) {}

Config Config::load(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  Config config;
  config.state_->root = load_config_tree(path);
  for (const std::string& text : overrides) apply_override(text, &config.state_->root);
  return config;
}

Config Config::parse(const std::string& text, const std::string& name) {
  Config config;
  config.state_->root = parse_config_tree(text, name);
  return config;
}

Config Config::at(const std::string& key) const {
  Config child(*this);
  child.prefix_ = prefix_ + key + ".";
  state_->known.insert(prefix_ + key);
  const ConfigTree* tree = state_->find(prefix_ + key);
  const bool empty = tree == nullptr || tree->kind == ConfigTree::Kind::Null;
  if (!empty && tree->kind != ConfigTree::Kind::Map) ill_typed(prefix_ + key, *tree, "a map");
  return child;
}

bool Config::has(const std::string& key) const { return state_->find(prefix_ + key) != nullptr; }

void Config::read(const std::string& key, bool* value) const { state_->read(prefix_ + key, value); }
void Config::read(const std::string& key, int* value) const { state_->read(prefix_ + key, value); }
void Config::read(const std::string& key, int64_t* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, uint64_t* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, float* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, double* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, std::string* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, std::vector<int64_t>* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, std::vector<double>* value) const {
  state_->read(prefix_ + key, value);
}
void Config::read(const std::string& key, std::vector<std::string>* value) const {
  state_->read(prefix_ + key, value);
}

std::string Config::where(const std::string& key) const {
  const ConfigTree* tree = state_->find(prefix_ + key);
  return tree == nullptr ? prefix_ + key : concat(tree->where, ": ", prefix_, key);
}

void Config::finish() const { check_known(state_->root, "", state_->known); }

std::string Config::to_yaml() const { return config_tree_to_yaml(state_->root); }

size_t find_name(const std::string& key, const std::string& text,
                 const std::vector<std::string>& names) {
  std::string choices;
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == text) return i;
    choices += (choices.empty() ? "" : " | ") + names[i];
  }
  const std::string nearest = nearest_name(text, names);
  throw Error(concat(key, ": expected ", choices, ", got ", quote(text),
                     nearest.empty() ? "" : "; did you mean " + quote(nearest) + "?"));
}

std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = edit_distance(word, candidate);
    if (distance >= best_distance) continue;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

}  // namespace lte
