#include "datagen/dataset/dataset_folder.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <sstream>
#include <system_error>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/base/version.h"

namespace lte::datagen {
namespace {

namespace fs = std::filesystem;

/// After this time no process is still writing dataset.json or config.yaml.
constexpr std::chrono::hours kStale{1};

/// Compares the settings of the data set that is there with `config`, but for the number of scenes.
/// @return  that number
/// @throws lte::Error naming the first line that differs.
int64_t check_same_config(const DatagenConfig& config, const fs::path& out) {
  DatagenConfig there = load_datagen_config(config_path(out));
  const int64_t scenes = there.scenes;
  there.scenes = config.scenes;
  std::istringstream ours(to_yaml(config)), theirs(to_yaml(there));
  std::string a, b;
  while (std::getline(ours, a) && std::getline(theirs, b))
    LTE_CHECK(a == b, out.string(), ": was made with another configuration (", b, " there, ", a,
              " now); use another --out");
  return scenes;
}

/// Another process may remove the same file at the same time, which is no error.
void remove_quietly(const fs::path& path) {
  std::error_code error;
  if (fs::remove(path, error)) log_info(path.string(), ": left by a killed run, removed");
}

/// "NAME.safetensors" of a temporary's name -> NAME.
std::string stem_of(const std::string& file) { return file.substr(0, file.find('.')); }

std::string numbered(const char* stem, int64_t index) {
  return formatted("%s_%05lld", stem, static_cast<long long>(index));
}

/// Whether the scenes there, finished or in work, have the name that both generators once gave.
bool has_scenes_named_rooms(const fs::path& out) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(out / "scenes", error)) {
    const std::string file = entry.path().filename().string();
    const std::string temporary_for = temporary_of(file);
    if ((temporary_for.empty() ? file : temporary_for).starts_with("room_")) return true;
  }
  return false;
}

/// Of files nobody knows before they are read: a model that learns from them counts as one that has
/// seen none.
bool has_suns(const DatagenConfig& config) {
  const boxes::RoomConfig& rooms = config.boxes;
  const bool boxes = (rooms.open_share > 0 && rooms.sky_share > 0) ||
                     (rooms.open_share < 1 && rooms.shut_sky_share > 0);
  return (config.makes(GeneratorKind::Boxes) && boxes) ||
         (config.makes(GeneratorKind::Homes) && config.homes.sun_share > 0) ||
         (config.makes(GeneratorKind::Wild) && config.wild.sky_share > 0);
}

}  // namespace

DatasetFolder::DatasetFolder(const DatagenConfig& config, fs::path out)
    : config_(config),
      out_(std::move(out)),
      planned_(config.scenes),
      named_rooms_(has_scenes_named_rooms(out_)) {}

data::Split DatasetFolder::split_of(int64_t index) const {
  return data::assign_split(config_.seed, index, config_.val_share, config_.test_share);
}

std::string DatasetFolder::name_of(int64_t index) const {
  return named_rooms_ ? numbered("room", index) : scene_name(config_.generator, index);
}

fs::path DatasetFolder::scene_path(int64_t index) const {
  return data::scene_path(out_, name_of(index));
}

void DatasetFolder::prepare(const Shard& shard, bool resume) {
  check_shard(shard);
  check_datagen_config(config_);
  std::error_code error;
  LTE_CHECK(!fs::exists(out_, error) || fs::is_directory(out_, error), out_.string(),
            ": exists and is not a directory; --out expects a directory");
  make_directory(out_);
  // Another shard that starts at the same moment has made scenes/ before it writes config.yaml.
  const fs::path scenes = out_ / "scenes";
  if (!fs::exists(config_path(out_))) {
    for (const auto& entry : fs::directory_iterator(out_)) {
      const std::string name = entry.path().filename().string();
      LTE_CHECK(name == "scenes" || name == "manifest" || name == "config.yaml" ||
                    temporary_of(name) == "config.yaml",
                out_.string(),
                ": not empty and not a data set; --out expects a new or an empty directory");
    }
  } else {
    planned_ = std::max(check_same_config(config_, out_), config_.scenes);
  }
  for (int64_t i = shard.index; !resume && i < config_.scenes; i += shard.count)
    LTE_CHECK(!fs::exists(scene_path(i)), scene_path(i).string(),
              ": is there already; pass --resume to keep what is done, or another --out");
  make_directory(scenes);
  DatagenConfig written = config_;
  written.scenes = planned_;
  // Untouched if it says so already, so that readers of a shared file system keep what they cached.
  const std::string text = to_yaml(written);
  if (!fs::exists(config_path(out_)) || read_file(config_path(out_)) != text)
    write_file(config_path(out_), text);
}

void DatasetFolder::remove_leftovers(const Shard& shard) const {
  std::set<std::string> own;
  for (int64_t i = shard.index; i < planned_; i += shard.count) own.insert(name_of(i));
  for (const auto& entry : fs::directory_iterator(out_ / "scenes")) {
    const std::string of = temporary_of(entry.path().filename().string());
    if (!of.empty() && own.count(stem_of(of)) > 0) remove_quietly(entry.path());
  }
  // The file system's own clock: that of the manifest that this run has just written to.
  auto now = fs::file_time_type::min();
  for (const auto& entry : fs::directory_iterator(manifest_folder(out_)))
    now = std::max(now, entry.last_write_time());
  for (const auto& entry : fs::directory_iterator(out_)) {
    std::error_code error;
    const auto time = fs::last_write_time(entry.path(), error);
    if (!error && !temporary_of(entry.path().filename().string()).empty() && time + kStale < now)
      remove_quietly(entry.path());
  }
}

bool DatasetFolder::is_done(int64_t index, const SceneRecord* record) const {
  const fs::path path = scene_path(index);
  std::error_code error;
  const uintmax_t bytes = fs::file_size(path, error);
  if (!fs::exists(path)) return false;
  if (!error && record != nullptr && record->error.empty() &&
      record->seed == scene_seed(config_.seed, index) &&
      record->bytes == static_cast<int64_t>(bytes))
    return true;
  try {
    const data::SceneSample sample = data::read_scene_sample(path);
    const bool same_rays = config_.bake.target_error > 0
                               ? sample.target_error == config_.bake.target_error
                               : sample.query_rays.empty() && sample.rays == config_.bake.rays;
    if (sample.seed == scene_seed(config_.seed, index) && same_rays &&
        sample.scene_points() == config_.bake.scene_points &&
        sample.query_points() == config_.bake.query_points)
      return true;
    log_warning(path.string(), ": is another scene; made again");
  } catch (const Error& fault) {
    log_warning(fault.what(), "; made again");
  }
  return false;
}

FolderState DatasetFolder::state() const {
  std::set<std::string> files;  // one listing instead of a look at each scene
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(out_ / "scenes", error))
    if (entry.is_regular_file()) files.insert(entry.path().filename().string());
  const SceneRecords records = read_manifests(out_);
  FolderState state;
  for (int64_t i = 0; i < planned_; ++i) {
    const auto record = records.find(i);
    if (files.count(scene_path(i).filename().string()) > 0) {
      state.there.push_back(i);
    } else if (record != records.end() && !record->second.error.empty()) {
      state.failed.push_back(concat(name_of(i), ": ", record->second.error));
    } else {
      state.missing.push_back(i);
    }
  }
  return state;
}

int64_t DatasetFolder::write_index(const FolderState& state) const {
  data::DatasetInfo info;
  info.tool_version = version();
  info.seed = config_.seed;
  info.scale = config_.scale;
  info.pruned = config_.bake.prune;
  info.suns = has_suns(config_);
  info.light_paths = config_.bake.light_paths;
  info.light_depth = config_.bake.max_depth;
  info.planned = planned_;
  for (const int64_t i : state.there)
    info.scenes.push_back({name_of(i), split_of(i), scene_seed(config_.seed, i),
                           config_.bake.scene_points, config_.bake.query_points});
  data::write_dataset_info(out_, info);
  return static_cast<int64_t>(info.scenes.size());
}

fs::path config_path(const fs::path& out) { return out / "config.yaml"; }

std::string scene_name(GeneratorKind kind, int64_t index) {
  switch (kind) {
    case GeneratorKind::Homes:
      return numbered("home", index);
    case GeneratorKind::Wild:
      return numbered("wild", index);
    case GeneratorKind::Mixed:
    case GeneratorKind::Files:
      return numbered("scene", index);
    default:
      return numbered("box", index);
  }
}

uint64_t scene_seed(uint64_t dataset_seed, int64_t index) {
  return hash_combine(dataset_seed, static_cast<uint64_t>(index));
}

}  // namespace lte::datagen
