#include "datagen/generate.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "datagen/room.h"
#include "lte/base/check.h"
#include "lte/base/cli.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/progress.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/data/dataset.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/export.h"

namespace lte::datagen {
namespace {

namespace fs = std::filesystem;

constexpr double kIndexSeconds = 10;  // dataset.json is at most that old when a run is killed

/// Keeps other shards out of the directory's list. The system drops the lock when a process dies.
class DirectoryLock {
 public:
  explicit DirectoryLock(const fs::path& directory)
      : fd_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY)) {
    LTE_CHECK(fd_ >= 0, directory.string(), ": cannot open: ", std::strerror(errno));
    // A file system without locks (some network ones) still serves shards that end one after
    // another.
    if (::flock(fd_, LOCK_EX) != 0)
      log_warning(directory.string(), ": cannot lock: ", std::strerror(errno));
  }
  ~DirectoryLock() { ::close(fd_); }
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int fd_;
};

fs::path config_path(const fs::path& out) { return out / "config.yaml"; }

void make_directory(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  LTE_CHECK(!error, path.string(), ": cannot make the directory: ", error.message());
}

/// @throws lte::Error unless the data set that is there was made with the same settings but for the
/// number of scenes.
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

class Generator {
 public:
  Generator(const DatagenConfig& config, const GenerateOptions& options)
      : config_(config), options_(options), listed_scenes_(config.scenes) {}

  GenerateResult run() {
    prepare();
    const int64_t own =
        (config_.scenes - options_.shard_index + options_.shard_count - 1) / options_.shard_count;
    {
      Progress progress("generating", std::max<int64_t>(own, 0), "scenes");
      for (int64_t i = options_.shard_index; i < config_.scenes; i += options_.shard_count) {
        make_scene(i);
        progress.advance();
        if (since_index_.seconds() > kIndexSeconds) write_index();
      }
    }
    write_index();
    result_.seconds = timer_.seconds();
    return result_;
  }

 private:
  void prepare();
  void make_scene(int64_t index);
  bool is_done(int64_t index) const;
  void export_glb(scene::Scene scene) const;
  void write_index();
  data::Split split_of(int64_t index) const {
    return data::assign_split(config_.seed, index, config_.val_share, config_.test_share);
  }
  fs::path path_of(int64_t index) const {
    return data::scene_path(options_.out, scene_name(index));
  }

  const DatagenConfig& config_;
  const GenerateOptions& options_;
  int64_t listed_scenes_;
  GenerateResult result_;
  Timer timer_, since_index_;
};

void Generator::prepare() {
  const fs::path& out = options_.out;
  LTE_CHECK(options_.shard_count >= 1 && options_.shard_index >= 0 &&
                options_.shard_index < options_.shard_count,
            "--shard: expected I/N with 0 <= I < N, got ", options_.shard_index, "/",
            options_.shard_count);
  check_datagen_config(config_);
  std::error_code error;
  LTE_CHECK(!fs::exists(out, error) || fs::is_directory(out, error), out.string(),
            ": exists and is not a directory; --out expects a directory");
  make_directory(out);
  const DirectoryLock lock(out);  // before looking: another shard may be writing config.yaml
  LTE_CHECK(fs::is_empty(out) || fs::exists(config_path(out)), out.string(),
            ": not empty and not a data set; --out expects a new or an empty directory");
  if (fs::exists(config_path(out))) {
    const int64_t there = check_same_config(config_, out);
    if (!options_.resume) {
      for (int64_t i = options_.shard_index; i < config_.scenes; i += options_.shard_count)
        LTE_CHECK(!fs::exists(path_of(i)), path_of(i).string(),
                  ": is there already; pass --resume to keep what is done, or another --out");
    }
    listed_scenes_ = std::max(there, config_.scenes);
  }
  DatagenConfig written = config_;
  written.scenes = listed_scenes_;
  write_file(config_path(out), to_yaml(written));
  make_directory(out / "scenes");
}

/// A scene that is there counts if it reads without fault and is the one that would be made.
bool Generator::is_done(int64_t index) const {
  const fs::path path = path_of(index);
  if (!fs::exists(path)) return false;
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
  } catch (const Error& error) {
    log_warning(error.what(), "; made again");
  }
  return false;
}

void Generator::make_scene(int64_t index) {
  const uint64_t seed = scene_seed(config_.seed, index);
  const std::string name = scene_name(index);
  const fs::path glb = fs::path(path_of(index)).replace_extension(".glb");
  const bool done = options_.resume && is_done(index);
  const bool wants_glb = options_.glb && !(done && fs::exists(glb));
  if (done) ++result_.kept;
  if (done && !wants_glb) return;
  const scene::Scene scene = generate_scene(config_, seed, name);
  const Vec3 extent = scene.bounds().extent();
  LTE_CHECK(max_component(extent) <= config_.scale, name, ": extent ", max_component(extent),
            " m exceeds scale ", config_.scale, " m");
  if (wants_glb) export_glb(scene);
  if (done) return;
  BakeOptions bake = config_.bake;
  bake.seed = seed;
  const auto& evaluated = config_.evaluation_splits;
  if (std::find(evaluated.begin(), evaluated.end(), data::split_name(split_of(index))) ==
      evaluated.end()) {
    bake.views.count = 0;
    bake.path_tracing_64 = false;
  }
  data::write_scene_sample(path_of(index), bake_scene(scene, bake, false));
  ++result_.baked;
}

/// With cameras, so that a viewer opens at a sensible place: the generator's, or the first view's.
void Generator::export_glb(scene::Scene scene) const {
  if (scene.cameras.empty()) {
    const scene::Scene geometry = scene;
    const pathtrace::Bvh bvh(geometry);
    scene.cameras = {pathtrace::auto_camera(bvh, 0)};
  }
  scene::write_glb(options_.out / "scenes" / (scene.name + ".glb"), scene);
}

/// Lists what is there, whoever made it: the last shard to end lists everything.
void Generator::write_index() {
  const DirectoryLock lock(options_.out);
  data::DatasetInfo info;
  info.tool_version = version();
  info.seed = config_.seed;
  info.scale = config_.scale;
  for (int64_t i = 0; i < listed_scenes_; ++i) {
    if (!fs::exists(path_of(i))) continue;
    info.scenes.push_back({scene_name(i), split_of(i), scene_seed(config_.seed, i),
                           config_.bake.scene_points, config_.bake.query_points});
  }
  result_.listed = static_cast<int64_t>(info.scenes.size());
  data::write_dataset_info(options_.out, info);
  since_index_.restart();
}

}  // namespace

GenerateResult generate_dataset(const DatagenConfig& config, const GenerateOptions& options) {
  return Generator(config, options).run();
}

scene::Scene generate_scene(const DatagenConfig& config, uint64_t seed, const std::string& name) {
  if (config.generator == "homes") return homes::generate_home(config.homes, seed, name).scene;
  return generate_room(config.rooms, seed, name).scene;
}

std::string scene_name(int64_t index) {
  char text[32];
  std::snprintf(text, sizeof text, "room_%05lld", static_cast<long long>(index));
  return text;
}

uint64_t scene_seed(uint64_t dataset_seed, int64_t index) {
  return hash_combine(dataset_seed, static_cast<uint64_t>(index));
}

}  // namespace lte::datagen
