#include "lte/data/dataset.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"

namespace lte::data {
namespace {

using Json = nlohmann::json;

constexpr const char* kDatasetFormat = "lte-dataset";
constexpr int kDatasetVersion = 1;
constexpr size_t kMaxNameLength = 200;

/// A name is part of a path: letters, digits and "_-." only, and no leading dot.
bool valid_name(const std::string& name) {
  return !name.empty() && name.size() <= kMaxNameLength && name[0] != '.' &&
         name.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.") ==
             std::string::npos;
}

const Json& member(const std::string& where, const Json& object, const char* key) {
  const auto found = object.find(key);
  LTE_CHECK(found != object.end(), where, ": key \"", key, "\" is missing");
  return *found;
}

std::string text_of(const std::string& where, const Json& object, const char* key) {
  const Json& value = member(where, object, key);
  LTE_CHECK(value.is_string(), where, ": key \"", key, "\": expected a string, got ", value.dump());
  return value.get<std::string>();
}

uint64_t count_of(const std::string& where, const Json& object, const char* key) {
  const Json& value = member(where, object, key);
  LTE_CHECK(value.is_number_unsigned(), where, ": key \"", key,
            "\": expected a non-negative integer, got ", value.dump());
  return value.get<uint64_t>();
}

/// A key that older files lack: from 1 to `most`, `fallback` without it.
int small_count(const std::string& file, const Json& json, const char* key, int fallback,
                uint64_t most) {
  if (!json.contains(key)) return fallback;
  const uint64_t value = count_of(file, json, key);
  LTE_CHECK(value >= 1 && value <= most, file, ": key \"", key, "\": expected 1 to ", most,
            ", got ", value);
  return static_cast<int>(value);
}

/// A key that files may lack: false without it.
bool switch_of(const std::string& file, const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return false;
  LTE_CHECK(found->is_boolean(), file, ": key \"", key, "\": expected true or false, got ",
            found->dump());
  return found->get<bool>();
}

DatasetEntry parse_entry(const std::string& where, const Json& json) {
  LTE_CHECK(json.is_object(), where, ": expected an object, got ", json.dump());
  DatasetEntry entry;
  entry.name = text_of(where, json, "name");
  LTE_CHECK(valid_name(entry.name), where, ": key \"name\": \"", entry.name,
            "\" is not a scene name (letters, digits, \"_\", \"-\", \".\")");
  try {
    entry.split = parse_split(text_of(where, json, "split"));
  } catch (const Error& error) {
    throw Error(concat(where, ": key \"split\": ", error.what()));
  }
  entry.seed = count_of(where, json, "seed");
  entry.scene_points = static_cast<int64_t>(count_of(where, json, "scene_points"));
  entry.query_points = static_cast<int64_t>(count_of(where, json, "query_points"));
  return entry;
}

std::filesystem::path info_path(const std::filesystem::path& directory) {
  return directory / "dataset.json";
}

}  // namespace

const char* split_name(Split split) {
  switch (split) {
    case Split::Train:
      return "train";
    case Split::Val:
      return "val";
    case Split::Test:
      return "test";
  }
  return "train";
}

Split parse_split(const std::string& word) {
  for (const Split split : {Split::Train, Split::Val, Split::Test})
    if (word == split_name(split)) return split;
  throw Error(concat("\"", word, "\" is not a split: expected train, val or test"));
}

void write_dataset_info(const std::filesystem::path& directory, const DatasetInfo& info) {
  std::string text = concat(
      "{\n\"format\": ", Json(kDatasetFormat).dump(), ",\n\"version\": ", kDatasetVersion,
      ",\n\"tool\": ", Json(info.tool_version).dump(), ",\n\"seed\": ", info.seed,
      ",\n\"scale\": ", Json(info.scale).dump(), ",\n\"light_paths\": ", info.light_paths,
      ",\n\"light_depth\": ", info.light_depth, ",\n\"pruned\": ", info.pruned ? "true" : "false",
      info.suns ? ",\n\"suns\": true" : "",
      ",\n\"planned\": ", std::max(info.planned, static_cast<int64_t>(info.scenes.size())),
      ",\n\"scenes\": [");
  const char* separator = "\n";
  for (const DatasetEntry& entry : info.scenes) {  // one line a scene, for people and for diff
    LTE_CHECK(valid_name(entry.name), info_path(directory).string(), ": \"", entry.name,
              "\" is not a scene name (letters, digits, \"_\", \"-\", \".\")");
    text += concat(separator, "{\"name\": ", Json(entry.name).dump(), ", \"split\": \"",
                   split_name(entry.split), "\", \"seed\": ", entry.seed,
                   ", \"scene_points\": ", entry.scene_points,
                   ", \"query_points\": ", entry.query_points, "}");
    separator = ",\n";
  }
  write_file(info_path(directory), text + "\n]\n}\n");
}

DatasetInfo read_dataset_info(const std::filesystem::path& directory, MissingScenes missing) {
  const std::string file = info_path(directory).string();
  LTE_CHECK(std::filesystem::is_directory(directory), directory.string(),
            ": no such data-set directory");
  if (!std::filesystem::exists(file) && std::filesystem::exists(directory / "config.yaml"))
    throw UnfinishedDataset(concat(file, ": missing: the data set is unfinished"));
  LTE_CHECK(std::filesystem::exists(file), file, ": missing; is this a data set?");
  const Json json = Json::parse(read_file(file), nullptr, false);
  LTE_CHECK(!json.is_discarded() && json.is_object(), file, ": not a JSON object, or truncated");
  LTE_CHECK(text_of(file, json, "format") == kDatasetFormat, file, ": key \"format\": expected \"",
            kDatasetFormat, "\"");
  DatasetInfo info;
  const uint64_t version = count_of(file, json, "version");
  LTE_CHECK(version >= 1 && version <= kDatasetVersion, file, ": key \"version\": ", version,
            " is not supported; this build reads up to ", kDatasetVersion, ": update lte");
  info.version = static_cast<int>(version);
  info.tool_version = text_of(file, json, "tool");
  info.seed = count_of(file, json, "seed");
  const Json& scale = member(file, json, "scale");
  LTE_CHECK(scale.is_number() && std::isfinite(scale.get<double>()) && scale.get<double>() > 0,
            file, ": key \"scale\": expected a positive number, got ", scale.dump());
  info.scale = scale.get<double>();
  info.pruned = switch_of(file, json, "pruned");
  info.suns = switch_of(file, json, "suns");
  info.light_paths = small_count(file, json, "light_paths", kDefaultLightPaths, 1 << 26);
  info.light_depth = small_count(file, json, "light_depth", kDefaultLightDepth, 1024);
  const Json& scenes = member(file, json, "scenes");
  LTE_CHECK(scenes.is_array(), file, ": key \"scenes\": expected a list");
  std::set<std::string> names;
  for (size_t i = 0; i < scenes.size(); ++i) {
    const std::string where = concat(file, ": scenes[", i, "]");
    info.scenes.push_back(parse_entry(where, scenes[i]));
    const std::string& name = info.scenes.back().name;
    LTE_CHECK(names.insert(name).second, where, ": key \"name\": \"", name, "\" is there twice");
    const std::filesystem::path path = scene_path(directory, name);
    if (missing == MissingScenes::Refuse && !std::filesystem::exists(path))
      throw UnfinishedDataset(concat(where, ": file ", path.string(), " is missing"));
  }
  const auto listed = static_cast<int64_t>(info.scenes.size());
  info.planned = listed;
  if (json.contains("planned"))
    info.planned = static_cast<int64_t>(count_of(file, json, "planned"));
  LTE_CHECK(info.planned >= listed, file, ": key \"planned\": ", info.planned, ", but ", listed,
            " scenes are listed");
  if (info.planned > listed)
    log_warning(file, ": unfinished: lists ", listed, " of ", info.planned, " scenes");
  return info;
}

std::filesystem::path scene_path(const std::filesystem::path& directory, const std::string& name) {
  return directory / "scenes" / (name + ".safetensors");
}

Split assign_split(uint64_t seed, int64_t index, double val_share, double test_share) {
  LTE_CHECK(val_share >= 0 && test_share >= 0 && val_share + test_share <= 1, "val_share ",
            val_share, " and test_share ", test_share,
            " must not be negative, nor exceed 1 together");
  // The golden-ratio sequence from a random start: the shares of any run of scenes are met to
  // within about one scene.
  constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio
  const uint64_t bits =
      hash_combine(seed, 0x73706c6974ULL) + static_cast<uint64_t>(index) * kGolden;
  const double u = static_cast<double>(bits >> 11) * 0x1p-53;
  if (u < test_share) return Split::Test;
  return u < test_share + val_share ? Split::Val : Split::Train;
}

std::vector<DatasetEntry> entries_of(const DatasetInfo& info, Split split) {
  std::vector<DatasetEntry> entries;
  for (const DatasetEntry& entry : info.scenes)
    if (entry.split == split) entries.push_back(entry);
  return entries;
}

}  // namespace lte::data
