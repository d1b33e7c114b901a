#include "datagen/dataset/generate.h"

#include <algorithm>
#include <vector>

#include <malloc.h>

#include "datagen/boxes/room.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/progress.h"
#include "lte/image/exr.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/scene/export.h"
#include "lte/scene/find_scenes.h"
#include "lte/scene/light_points.h"
#include "lte/scene/load_camera.h"

namespace lte::datagen {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMixedStream = 0x6d69786564;  // "mixed"

/// Writes the environment of a scene, which glTF has no place for, as `--environment` reads it.
void export_sky(const fs::path& path, const scene::Environment& sky) {
  image::Image picture(sky.map ? sky.map->width() : 2, sky.map ? sky.map->height() : 1, 3);
  for (size_t i = 0; i < picture.pixels.size() / 3; ++i)
    picture.set_rgb(i, sky.map ? sky.radiance * sky.map->texel(i) : sky.radiance);
  image::write_exr(path, {{"", &picture}});
}

/// Writes a scene with cameras, so that a viewer opens at a sensible place: those of the generator,
/// or that of the first view.
void export_glb(fs::path path, scene::Scene scene) {
  if (scene.cameras.empty()) {
    const scene::Scene geometry = scene;
    const pathtrace::Bvh bvh(geometry);
    scene.cameras = {pathtrace::auto_camera(bvh, 0)};
  }
  scene::write_glb(path, scene);
  if (scene.environment) export_sky(path.replace_extension(".sky.exr"), *scene.environment);
}

/// Returns the memory of the last scene to the system. The heap would keep that of the largest
/// scene, and more.
void release_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

/// The files of the scenes, in order; none where a generator makes them.
std::vector<scene::FoundScene> files_of(const DatagenConfig& config) {
  if (config.generator != GeneratorKind::Files) return {};
  LTE_CHECK(fs::is_directory(config.files.folder), "files.folder: there is no folder ",
            config.files.folder);
  std::vector<scene::FoundScene> files = scene::find_scenes({config.files.folder}).scenes;
  LTE_CHECK(config.scenes <= static_cast<int64_t>(files.size()), "scenes: expected at most ",
            files.size(), ", as many as there are in files.folder, ", config.files.folder, ", got ",
            config.scenes);
  return files;
}

scene::Scene read_scene(const scene::FoundScene& file, const SceneFlags& loading) {
  scene::Scene scene = load_scene(file.path, loading);
  if (!file.camera.empty()) scene.cameras = {scene::load_camera(file.camera)};
  return scene;
}

class Generator {
 public:
  Generator(const DatagenConfig& config, const GenerateOptions& options,
            const SceneMaker& make_scene)
      : config_(config),
        options_(options),
        files_(files_of(config)),
        make_scene_(make_scene),
        folder_(config, options.out) {
    if (make_scene_) return;
    make_scene_ = [this](int64_t index, const std::string& name) {
      if (!files_.empty()) return read_scene(files_[static_cast<size_t>(index)], options_.loading);
      return generate_scene(config_, scene_seed(config_.seed, index), name);
    };
  }

  GenerateResult run() {
    folder_.prepare(options_.shard, options_.resume);
    Manifest manifest(options_.out, options_.shard);
    manifest.begin(config_.seed, to_yaml(config_));
    folder_.remove_leftovers(options_.shard);
    const std::vector<int64_t> todo = keep_what_is_there();
    make(todo, &manifest);
    manifest.end(result_.baked, result_.kept, result_.failed, timer_.seconds());
    const FolderState state = folder_.state();
    result_.planned = folder_.planned();
    result_.missing = static_cast<int64_t>(state.missing.size());
    if (state.missing.empty()) result_.listed = folder_.write_index(state);
    result_.seconds = timer_.seconds();
    return result_;
  }

 private:
  std::vector<int64_t> keep_what_is_there();
  void make(const std::vector<int64_t>& todo, Manifest* manifest);
  SceneRecord attempt(int64_t index) const;
  void make_scene(int64_t index, SceneRecord* record) const;
  std::string source_of(int64_t index) const {
    return files_.empty() ? "" : files_[static_cast<size_t>(index)].name;
  }
  fs::path glb_path(int64_t index) const {
    return folder_.scene_path(index).replace_extension(".glb");
  }

  const DatagenConfig& config_;
  const GenerateOptions& options_;
  std::vector<scene::FoundScene> files_;
  SceneMaker make_scene_;
  DatasetFolder folder_;
  GenerateResult result_;
  Timer timer_;
  int64_t timed_ = 0;         // number of kept scenes whose seconds are known
  double timed_seconds_ = 0;  // their sum
};

/// Returns the scenes of this shard that are still to be made. Kept scenes get a .glb if it is
/// asked for and missing.
std::vector<int64_t> Generator::keep_what_is_there() {
  const SceneRecords records = read_manifests(options_.out);
  std::vector<int64_t> todo;
  for (int64_t i = options_.shard.index; i < config_.scenes; i += options_.shard.count) {
    const auto found = records.find(i);
    const SceneRecord* record = found == records.end() ? nullptr : &found->second;
    // Files may have come or gone since. What was read from another must not stay in its place,
    // should this one fail.
    const bool same = record == nullptr || record->source == source_of(i);
    if (!same) {
      fs::remove(folder_.scene_path(i));
      fs::remove(glb_path(i));
    }
    const bool done = options_.resume && same && folder_.is_done(i, record);
    if (done) ++result_.kept;
    if (done && record != nullptr && record->error.empty()) {
      ++timed_;
      timed_seconds_ += record->seconds;
    }
    if (!done) {
      todo.push_back(i);
    } else if (options_.glb && !fs::exists(glb_path(i))) {
      export_glb(glb_path(i), make_scene_(i, folder_.name_of(i)));
    }
  }
  return todo;
}

void Generator::make(const std::vector<int64_t>& todo, Manifest* manifest) {
  const auto total = static_cast<int64_t>(todo.size());
  Progress progress("generating", result_.kept + total, "scenes");
  progress.resume(result_.kept, timed_, timed_seconds_);
  int in_a_row = 0;
  for (const int64_t i : todo) {
    const SceneRecord record = attempt(i);
    release_free_memory();
    manifest->add(record);
    progress.advance();
    if (record.error.empty()) {
      ++result_.baked;
      in_a_row = 0;
      continue;
    }
    const std::string what = concat(record.name, ": ", record.error);
    if (result_.failed++ == 0) result_.first_error = what;
    log_warning(what);
    LTE_CHECK(!options_.strict, what, "; --strict ends the run");
    LTE_CHECK(++in_a_row < kFailuresInARow, what, "; ", kFailuresInARow,
              " scenes in a row failed, so the run ends");
  }
}

/// Makes one scene. An error ends up in the record, but for a full disk.
SceneRecord Generator::attempt(int64_t index) const {
  SceneRecord record;
  record.index = index;
  record.name = folder_.name_of(index);
  record.split = data::split_name(folder_.split_of(index));
  record.seed = scene_seed(config_.seed, index);
  record.source = source_of(index);
  const Timer timer;
  try {
    make_scene(index, &record);
  } catch (const DiskFull&) {  // no fault of this scene: the next would fail too
    throw;
  } catch (const std::exception& error) {  // lte::Error, std::bad_alloc, ...
    record.error = *error.what() != '\0' ? error.what() : "unknown fault";
  }
  record.seconds = timer.seconds();
  return record;
}

void Generator::make_scene(int64_t index, SceneRecord* record) const {
  const Timer timer;
  const scene::Scene scene = make_scene_(index, record->name);
  record->generate_s = timer.seconds();
  record->triangles = scene.triangle_count();
  const Vec3 extent = scene::point_bounds(scene).extent();
  LTE_CHECK(max_component(extent) <= config_.scale, "extent ", max_component(extent),
            " m exceeds scale ", config_.scale, " m");
  if (options_.glb) export_glb(glb_path(index), scene);
  const Timer bake_timer;
  const fs::path path = folder_.scene_path(index);
  const data::SceneSample sample =
      bake_scene(scene, bake_options(config_, index, scene), false, &record->rays);
  // dataset.json promises these counts of every scene.
  LTE_CHECK(sample.scene_points() == config_.bake.scene_points &&
                sample.query_points() == config_.bake.query_points,
            "light reaches so little of the surface that only ", sample.scene_points(),
            " scene and ", sample.query_points(), " query points were found");
  data::write_scene_sample(path, sample);
  record->bake_s = bake_timer.seconds();
  record->bytes = static_cast<int64_t>(fs::file_size(path));
}

}  // namespace

GenerateResult generate_dataset(const DatagenConfig& config, const GenerateOptions& options,
                                const SceneMaker& make_scene) {
  try {
    return Generator(config, options, make_scene).run();
  } catch (const DiskFull& error) {
    throw Error(
        concat(error.what(), "; the finished scenes stay: make room and go on with --resume"));
  }
}

GenerateResult merge_dataset(const fs::path& out) {
  LTE_CHECK(fs::exists(config_path(out)), out.string(),
            ": not a data set of lte_datagen generate: it has no config.yaml");
  const DatagenConfig config = load_datagen_config(config_path(out));
  DatasetFolder folder(config, out);
  const FolderState state = folder.state();
  GenerateResult result;
  result.planned = config.scenes;
  result.missing = static_cast<int64_t>(state.missing.size());
  result.failed = static_cast<int64_t>(state.failed.size());
  if (!state.failed.empty()) result.first_error = state.failed.front();
  result.listed = folder.write_index(state);
  return result;
}

GeneratorKind generator_of(const DatagenConfig& config, uint64_t seed) {
  if (config.generator != GeneratorKind::Mixed) return config.generator;
  const MixedConfig& mixed = config.mixed;
  const double at = Rng(seed, kMixedStream).uniform() * (mixed.boxes + mixed.homes + mixed.wild);
  if (at < mixed.boxes) return GeneratorKind::Boxes;
  return at < mixed.boxes + mixed.homes ? GeneratorKind::Homes : GeneratorKind::Wild;
}

scene::Scene generate_scene(const DatagenConfig& config, uint64_t seed, const std::string& name) {
  const GeneratorKind kind = generator_of(config, seed);
  LTE_CHECK(kind != GeneratorKind::Files, "generator: files have no scene of a seed");
  scene::Scene scene;
  SideConfig sides = config.sides;
  if (kind == GeneratorKind::Wild) {
    scene = wild::generate_wild(config.wild, seed, name).scene;
    sides.two_sided_share = 0;  // it has two-sided lamps of its own
  } else if (kind == GeneratorKind::Homes) {
    scene = homes::generate_home(config.homes, seed, name).scene;
  } else {
    scene = boxes::generate_room(config.boxes, seed, name).scene;
  }
  add_metals(config.metals, seed, &scene);
  vary_sides(sides, seed, &scene);
  return scene;
}

scene::Scene make_scene(const DatagenConfig& config, int64_t index) {
  if (config.generator == GeneratorKind::Files) {
    const std::vector<scene::FoundScene> files = files_of(config);
    LTE_CHECK(index >= 0 && index < static_cast<int64_t>(files.size()), "index: expected one of ",
              files.size(), " files, got ", index);
    return read_scene(files[static_cast<size_t>(index)], {});
  }
  return generate_scene(config, scene_seed(config.seed, index),
                        scene_name(config.generator, index));
}

BakeOptions bake_options(const DatagenConfig& config, int64_t index, const scene::Scene& scene) {
  BakeOptions bake = config.bake;
  bake.seed = scene_seed(config.seed, index);
  bake.view_cameras = scene.cameras;
  const data::Split split =
      data::assign_split(config.seed, index, config.val_share, config.test_share);
  const auto& evaluated = config.evaluation_splits;
  if (std::find(evaluated.begin(), evaluated.end(), data::split_name(split)) == evaluated.end()) {
    bake.views.count = 0;
    bake.path_tracing_64 = false;
  }
  return bake;
}

}  // namespace lte::datagen
