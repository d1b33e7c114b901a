#include "lte/base/config_tree.h"

#include <algorithm>
#include <set>

#include <yaml-cpp/yaml.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"

namespace lte {
namespace {

namespace fs = std::filesystem;

/// Turns YAML nodes into a tree. Aliases can make a short text a huge or an endless tree, hence the
/// limits.
class Converter {
 public:
  Converter(std::string name, bool with_lines) : name_(std::move(name)), with_lines_(with_lines) {}

  ConfigTree convert(const YAML::Node& node, int depth = 0) {
    ConfigTree tree;
    tree.where = where(node.Mark());
    LTE_CHECK(depth <= kMaxDepth, tree.where, ": nested deeper than ", kMaxDepth, " levels");
    LTE_CHECK(++count_ <= kMaxNodes, tree.where, ": more than ", kMaxNodes, " values");
    if (node.IsMap()) {
      add_entries(node, depth, &tree);
    } else if (node.IsSequence()) {
      tree.kind = ConfigTree::Kind::List;
      for (const YAML::Node& item : node) tree.items.push_back(convert(item, depth + 1));
    } else if (node.IsScalar()) {
      tree.kind = ConfigTree::Kind::Scalar;
      tree.text = node.Scalar();
      tree.quoted = node.Tag() == "!";
    } else {
      tree.kind = ConfigTree::Kind::Null;
    }
    return tree;
  }

 private:
  static constexpr int kMaxDepth = 64;
  static constexpr int kMaxNodes = 1'000'000;

  std::string where(const YAML::Mark& mark) const {
    return with_lines_ && mark.line >= 0 ? concat(name_, ":", mark.line + 1) : name_;
  }

  void add_entries(const YAML::Node& node, int depth, ConfigTree* tree) {
    std::set<std::string> seen;
    for (const auto& entry : node) {
      const std::string at = where(entry.first.Mark());
      LTE_CHECK(entry.first.IsScalar(), at, ": expected a plain key");
      const std::string key = entry.first.Scalar();
      LTE_CHECK(seen.insert(key).second, at, ": key ", quote(key), " stands here twice");
      ConfigTree value = convert(entry.second, depth + 1);
      value.where = at;
      tree->entries.emplace_back(key, std::move(value));
    }
  }

  std::string name_;
  bool with_lines_;
  int count_ = 0;
};

ConfigTree null_tree(const std::string& where) {
  ConfigTree tree;
  tree.kind = ConfigTree::Kind::Null;
  tree.where = where;
  return tree;
}

ConfigTree parse_text(const std::string& text, const std::string& name, bool with_lines) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    LTE_CHECK(documents.size() <= 1, name, ": expected one YAML document, got ", documents.size());
    Converter converter(name, with_lines);
    return documents.empty() ? null_tree(name) : converter.convert(documents[0]);
  } catch (const YAML::Exception& error) {
    const bool located = with_lines && error.mark.line >= 0;
    throw Error(concat(name, located ? concat(":", error.mark.line + 1) : "",
                       ": not valid YAML: ", error.msg));
  }
}

ConfigTree parse_map(const std::string& text, const std::string& name) {
  ConfigTree tree = parse_text(text, name, true);
  if (tree.kind == ConfigTree::Kind::Null) tree = ConfigTree{};  // an empty file
  LTE_CHECK(tree.kind == ConfigTree::Kind::Map, name, ": expected a map of keys, got ",
            shown(tree));
  return tree;
}

/// Maps merge, everything else replaces.
void merge(ConfigTree* base, ConfigTree over) {
  if (base->kind != ConfigTree::Kind::Map || over.kind != ConfigTree::Kind::Map) {
    *base = std::move(over);
    return;
  }
  base->where = over.where;
  for (auto& [key, value] : over.entries) {
    if (base->find(key) == nullptr) {
      base->slot(key) = std::move(value);
    } else {
      merge(&base->slot(key), std::move(value));
    }
  }
}

ConfigTree load_chain(const fs::path& path, std::vector<fs::path>* chain) {
  constexpr size_t kLimitBytes = size_t{16} << 20;
  std::error_code ignored;
  const fs::path identity = fs::weakly_canonical(path, ignored);
  LTE_CHECK(std::find(chain->begin(), chain->end(), identity) == chain->end(), path.string(),
            ": its chain of parents leads back to itself");
  chain->push_back(identity);
  ConfigTree own = parse_map(read_file(path, kLimitBytes), path.string());
  const ConfigTree* parent = own.find("parent");
  if (parent == nullptr) return own;
  LTE_CHECK(parent->kind == ConfigTree::Kind::Scalar && !parent->text.empty(), parent->where,
            ": parent: expected the name of a file, got ", shown(*parent));
  const fs::path parent_path = path.parent_path() / parent->text;
  LTE_CHECK(fs::exists(parent_path, ignored), parent->where, ": parent: ", parent_path.string(),
            " does not exist");
  ConfigTree base = load_chain(parent_path, chain);
  std::erase_if(own.entries, [](const auto& entry) { return entry.first == "parent"; });
  merge(&base, std::move(own));
  return base;
}

void emit(const ConfigTree& tree, YAML::Emitter* out) {
  switch (tree.kind) {
    case ConfigTree::Kind::Null:
      *out << YAML::Null;
      break;
    case ConfigTree::Kind::Scalar:
      if (tree.quoted) *out << YAML::DoubleQuoted;
      *out << tree.text;
      break;
    case ConfigTree::Kind::List:
      *out << YAML::Flow << YAML::BeginSeq;
      for (const ConfigTree& item : tree.items) emit(item, out);
      *out << YAML::EndSeq;
      break;
    case ConfigTree::Kind::Map:
      *out << YAML::BeginMap;
      for (const auto& [key, value] : tree.entries) {
        *out << YAML::Key << key << YAML::Value;
        emit(value, out);
      }
      *out << YAML::EndMap;
      break;
  }
}

}  // namespace

ConfigTree::ConfigTree() = default;
ConfigTree::ConfigTree(const ConfigTree& other) = default;
ConfigTree::ConfigTree(ConfigTree&& other) noexcept = default;
ConfigTree& ConfigTree::operator=(const ConfigTree& other) = default;
ConfigTree& ConfigTree::operator=(ConfigTree&& other) noexcept = default;
ConfigTree::~ConfigTree() = default;

std::string shown(const ConfigTree& tree) {
  switch (tree.kind) {
    case ConfigTree::Kind::Null:
      return "nothing";
    case ConfigTree::Kind::Scalar:
      return quote(tree.text);
    case ConfigTree::Kind::List:
      return "a list";
    case ConfigTree::Kind::Map:
      return "a map";
  }
  return "";
}

ConfigTree parse_config_tree(const std::string& text, const std::string& name) {
  return parse_map(text, name);
}

ConfigTree load_config_tree(const fs::path& path) {
  std::vector<fs::path> chain;
  return load_chain(path, &chain);
}

void apply_override(const std::string& text, ConfigTree* root) {
  const std::string where = "override " + quote(text);
  const size_t equals = text.find('=');
  LTE_CHECK(equals != std::string::npos, where, ": expected key=value");
  const std::string key = text.substr(0, equals);
  ConfigTree value = parse_text(text.substr(equals + 1), where, false);
  ConfigTree* place = root;
  for (size_t begin = 0; begin <= key.size();) {
    const size_t end = std::min(key.find('.', begin), key.size());
    LTE_CHECK(end > begin, where, ": expected key=value, got an empty key");
    if (place->kind == ConfigTree::Kind::Null) place->kind = ConfigTree::Kind::Map;
    LTE_CHECK(place->kind == ConfigTree::Kind::Map, where, ": ", quote(key.substr(0, begin - 1)),
              " is not a map");
    place = &place->slot(key.substr(begin, end - begin));
    if (place->where.empty()) place->where = where;
    begin = end + 1;
  }
  value.where = where;
  merge(place, std::move(value));
}

std::string config_tree_to_yaml(const ConfigTree& root) {
  YAML::Emitter out;
  emit(root, &out);
  return std::string(out.c_str()) + "\n";
}

}  // namespace lte
