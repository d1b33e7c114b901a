#include "infer/eval/scenes/scenes.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "infer/eval/measure/reference_pair.h"
#include "infer/eval/scenes/kept_results.h"
#include "infer/eval/scenes/scene_reference.h"
#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/cli/progress.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
/// Steps of progress that both references take, a method taking one: about as their times are.
constexpr int64_t kReferenceSteps = 8;
/// Of the key of a kept result: another one wherever the figures mean something else than before.
constexpr int kFigures = 1;

/// A run over scenes: what they share.
class ScenesRun {
 public:
  ScenesRun(const scene::FoundScenes& files, const std::vector<SceneModel>& models,
            const std::vector<std::string>& words, const ScenesOptions& options)
      : files_(files),
        models_(models),
        options_(options),
        methods_(scene_methods(words, models)),
        kept_(options.report),
        aspect_(static_cast<float>(options.width) / static_cast<float>(options.height)) {
    for (const SceneModel& model : models) prints_.push_back(model.network.fingerprint());
  }

  /// Before anything is computed.
  void check_camera_files() {
    for (const scene::FoundScene& file : files_.scenes) {
      if (file.camera.empty()) continue;
      scene::load_camera(file.camera);
      std::optional<SceneView> view;
      try {
        view = load_view(file, options_.loading, aspect_, denoiser_);
      } catch (const std::exception&) {
        continue;  // said beside the scene when its turn comes
      }
      check_camera_file(file, *view, aspect_);
    }
  }

  ScenesResult run() {
    ScenesResult out;
    out.methods = methods_;
    out.parts = files_.parts;
    const int64_t steps = kReferenceSteps + static_cast<int64_t>(methods_.size());
    progress_.emplace("scenes", steps * static_cast<int64_t>(files_.scenes.size()), "steps");
    for (size_t i = 0; i < files_.scenes.size(); ++i) {
      steps_ = 0;
      SceneOutcome scene = outcome_of(files_.scenes[i]);
      progress_->advance(steps - steps_);
      log_info(i + 1, "/", files_.scenes.size(), " ", line_of(scene));
      out.scenes.push_back(std::move(scene));
    }
    progress_->finish();
    return out;
  }

 private:
  void advance(int64_t steps) {
    progress_->advance(steps);
    steps_ += steps;
  }

  std::string line_of(const SceneOutcome& scene) const {
    if (!scene.error.empty()) return scene.name + ": " + scene.error;
    int right = 0, measured = 0;
    for (const MethodOutcome& method : scene.methods) {
      measured += method.not_measured.empty() ? 1 : 0;
      right += method.not_measured.empty() && method.figures.irradiance.is_right() ? 1 : 0;
    }
    return concat(scene.name, ": ", right, " of ", measured, " methods right");
  }

  SceneOutcome outcome_of(const scene::FoundScene& file) {
    SceneOutcome out;
    out.name = file.name;
    try {
      SceneView view = load_view(file, options_.loading, aspect_, denoiser_);
      out.camera = scene::camera_json(view.camera);
      out.camera_from = view.camera_from;
      out.triangles = view.scene->triangle_count();
      out.notes = view.notes;
      for (const std::string& note : size_notes(view, models_)) out.notes.push_back(note);
      measure(&view, &out);
    } catch (const ReferenceFault&) {
      throw;
    } catch (const DiskFull&) {
      throw;
    } catch (const std::exception& error) {
      out.error = first_line(error.what());
      out.methods.clear();
    }
    return out;
  }

  PairSettings pair_settings() const {
    PairSettings out;
    out.width = options_.width;
    out.height = options_.height;
    out.paths = options_.reference_paths;
    out.max_depth = options_.max_depth;
    out.seed = options_.seed;
    out.irradiance = true;
    out.folder = options_.references;
    out.progress = false;
    return out;
  }

  /// What decides a method's result, beside the program itself.
  std::string key_of(const std::string& view_print, const SceneMethod& method) const {
    Checksum sum;
    const std::string model = method.model != nullptr
                                  ? prints_[static_cast<size_t>(method.model - models_.data())] +
                                        concat(static_cast<int>(method.model->network.precision()))
                                  : "";
    sum.add(concat(kFigures, ' ', view_print, ' ', method.name, ' ', method.settings, ' ',
                   options_.seed, ' ', model, ' ', program_));
    return sum.text();
  }

  void measure(SceneView* view, SceneOutcome* out) {
    const bool keeps = !options_.report.empty();
    const std::string print =
        keeps ? pair_fingerprint(*view->renderer, view->camera, pair_settings()) : "";
    ScenePainter painter(view, {options_.width, options_.height, options_.max_depth, options_.seed,
                                options_.memory});
    out->png = kept_.find_picture(view->name);
    std::optional<SceneReference> reference;
    for (const SceneMethod& method : methods_) {
      const std::string name = view->name + " " + method.name;
      MethodOutcome outcome;
      outcome.not_measured = painter.not_for(method);
      if (outcome.not_measured.empty()) {
        const std::string key = keeps ? key_of(print, method) : "";
        std::optional<MethodOutcome> found;
        if (options_.resume && !out->png.empty()) found = kept_.find(name, key);
        if (!found) {
          if (!reference) reference = find_reference(view, out);
          warm_up(method, view);
          found = measure_method(*reference, method, &painter);
          kept_.keep(name, key, *found);
        }
        outcome = std::move(*found);
      }
      out->methods.push_back(std::move(outcome));
      advance(1);
    }
  }

  SceneReference find_reference(SceneView* view, SceneOutcome* out) {
    PairSettings settings = pair_settings();
    const int64_t all = settings.pair_pixels();
    std::atomic<int64_t> traced{0};
    settings.done = [&](int64_t pixels) {
      const int64_t before = traced.fetch_add(pixels);
      advance(kReferenceSteps * (before + pixels) / all - kReferenceSteps * before / all);
    };
    ReferencePair pair =
        find_reference_pair(view->renderer.get(), view->camera, view->name, settings);
    advance(kReferenceSteps - kReferenceSteps * traced / all);
    SceneReference reference(std::move(pair),
                             irradiance_mask(*view, options_.width, options_.height),
                             options_.reference_paths);
    if (!options_.report.empty()) {
      out->png = reference.png();
      kept_.keep_picture(view->name, out->png);
    }
    return reference;
  }

  MethodOutcome measure_method(const SceneReference& reference, const SceneMethod& method,
                               ScenePainter* painter) {
    const ScenePictures pictures = painter->paint(method);
    options_.memory.check("a scene");
    MethodOutcome out;
    out.figures = reference.compare(pictures);
    if (!options_.report.empty()) out.png = reference.png_of(pictures.whole, pictures.irradiance);
    return out;
  }

  /// What a process does once is nobody's time: a small picture of each method before its first.
  void warm_up(const SceneMethod& method, SceneView* view) {
    if (std::find(warm_.begin(), warm_.end(), method.name) != warm_.end()) return;
    warm_.push_back(method.name);
    ScenePainter(view, {32, 24, options_.max_depth, options_.seed, options_.memory}).paint(method);
  }

  const scene::FoundScenes& files_;
  const std::vector<SceneModel>& models_;
  const ScenesOptions& options_;
  const std::vector<SceneMethod> methods_;
  const KeptResults kept_;
  const float aspect_;
  std::optional<Progress> progress_;
  std::atomic<int64_t> steps_{0};  ///< of the scene that is worked on
  std::shared_ptr<SharedDenoiser> denoiser_ = std::make_shared<SharedDenoiser>();
  std::vector<std::string> prints_;  ///< of the models
  std::vector<std::string> warm_;
  /// Results of another build may differ.
  const std::string program_ = [] {
    const fs::path file = fs::read_symlink("/proc/self/exe");
    return concat(fs::file_size(file), ' ', fs::last_write_time(file).time_since_epoch().count());
  }();
};

}  // namespace

ScenesResult evaluate_scenes(const scene::FoundScenes& files, const std::vector<SceneModel>& models,
                             const std::vector<std::string>& method_words,
                             const ScenesOptions& options) {
  check_kept_pairs(options.references);
  ScenesRun run(files, models, method_words, options);
  run.check_camera_files();
  ScenesResult out = run.run();
  const bool any = std::any_of(out.scenes.begin(), out.scenes.end(),
                               [](const SceneOutcome& scene) { return scene.error.empty(); });
  LTE_CHECK(any, out.scenes.front().error,
            out.scenes.size() > 1
                ? concat("; and none of ", out.scenes.size() - 1, " other scenes was measured")
                : "");
  return out;
}

}  // namespace lte::infer
