#include "train/command/fit_command.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/cli/progress.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/writable.h"
#include "lte/embed/embedding_key.h"
#include "train/fit/fit.h"

namespace lte::train {

struct FitOptions : SceneSource {
  std::string out, model, start;
  std::string time = "60s";
  int64_t points = int64_t{1} << 16, steps = 0;
  uint64_t seed = 0;
};

namespace {

/// Shares of the time as a line of progress.
class FitProgress {
 public:
  explicit FitProgress(const std::string& scene)
      : scene_(scene), line_(concat("fitting ", scene), kParts, "parts") {}

  void show(double share) {
    const auto parts = static_cast<int64_t>(share * kParts);
    if (parts > shown_) line_.advance(parts - shown_);
    shown_ = std::max(shown_, parts);
  }

 private:
  static constexpr int64_t kParts = 1000;
  std::string scene_;
  Progress line_;
  int64_t shown_ = 0;
};

double percent(double relative_mse) { return 100 * std::sqrt(relative_mse); }

std::string summary(const FitOptions& options, const Fit& fit) {
  return formatted(
      "%s: error at %lld points that were not shown: %.2f %% of the light before, %.2f %% after "
      "(%.3g W/m^2), by %lld points of %lld paths\n%s: give it to lte_render or lte_probe as "
      "--embedding with --integrator network\n",
      options.scene.c_str(), static_cast<long long>(fit.held_out), percent(fit.before.relative_mse),
      percent(fit.after.relative_mse), fit.after.rms, static_cast<long long>(fit.points),
      static_cast<long long>(fit.rays), options.out.c_str());
}

nlohmann::json json_of(const FitOptions& options, const Fit& fit, double seconds) {
  return {{"scene", options.scene},
          {"embedding", options.out},
          {"latents", fit.latents},
          {"points", fit.points},
          {"paths_a_point", fit.rays},
          {"steps", fit.steps},
          {"held_out_points", fit.held_out},
          {"relmse_before", fit.before.relative_mse},
          {"relmse_after", fit.after.relative_mse},
          {"rms_before", fit.before.rms},
          {"rms_after", fit.after.rms},
          {"trace_seconds", fit.trace_s},
          {"learn_seconds", fit.learn_s},
          {"seconds", seconds},
          {"processor_seconds", processor_seconds()}};
}

void claim_files(const FitOptions& options, const CommonOptions& common, CommandFiles* files) {
  claim_scene(options, files);
  files->reads("--checkpoint", options.model);
  files->reads("--embedding", options.start);
  files->writes("--out", options.out);
  files->writes_common(common);
  files->check();
  for (const std::string& path : {options.out, common.json}) check_writable(path);
}

}  // namespace

FitCommand::FitCommand(CLI::App& app, CommonOptions* common)
    : options_(std::make_unique<FitOptions>()) {
  CLI::App* fit = app.add_subcommand(
      "fit",
      "Write the embedding of one scene that answers it best: path-trace points of the scene, "
      "and let the latents of a model learn them");
  FitOptions* o = options_.get();
  fit->add_option("SCENE", o->scene, "Scene: .gltf, .glb, .pbrt, .obj or .ply")->required();
  fit->add_option("--out", o->out, "Embedding to write")->required();
  fit->add_option("--checkpoint", o->model, "Model; by default lte");
  fit->add_option("--embedding", o->start, "Begin with this embedding of an earlier fit");
  fit->add_option("--time", o->time, "Time of paths and learning: 90s, 500ms")
      ->check(a_time())
      ->capture_default_str();
  fit->add_option("--steps", o->steps,
                  "Steps of learning instead of a time: the same embedding on every machine")
      ->check(positive_number())
      ->excludes(fit->get_option("--time"));
  fit->add_option("--points", o->points, "With --steps: points that are learnt, of 64 paths each")
      ->check(positive_number())
      ->needs(fit->get_option("--steps"))
      ->capture_default_str();
  fit->add_option("--seed", o->seed, "Seed of points and paths; that of lte_render and lte_probe")
      ->capture_default_str();
  add_scene_options(*fit, o);
  add_common_options(*fit, common);
  command_ = fit;
}

FitCommand::~FitCommand() = default;

std::string FitCommand::run(const CommonOptions& common) {
  const FitOptions& options = *options_;
  CommandFiles files;
  claim_files(options, common, &files);
  const Timer timer;
  const scene::Scene scene = load_source(options);
  describe(scene, options.scene);
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  LTE_CHECK(!lights.empty(), options.scene,
            ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  runtime::set_torch_threads(common.threads);
  const runtime::Network network(checkpoint_or_shipped(options.model));
  files.check_what_was_read();
  embed::EmbedSettings settings;
  settings.seed = options.seed;
  settings.rescale = true;
  const runtime::EmbeddingKey key = embed::embedding_key(bvh, network, settings);
  const runtime::SceneEmbedding start = options.start.empty()
                                            ? embed::embed(bvh, lights, network, settings).embedding
                                            : runtime::load_embedding(options.start, network, key);
  FitSettings limits;
  if (options.steps > 0) {
    limits.steps = options.steps;
    limits.points = options.points;
  } else {
    limits.seconds = parse_time(options.time);
  }
  limits.seed = options.seed;
  FitProgress progress(options.scene);
  limits.progress = [&](const char*, double share) { progress.show(share); };
  const Fit fit = fit_embedding(bvh, lights, start, limits);
  if (fit.steps == 0)
    log_warning(options.scene, ": no time was left to learn in; give --time more than ",
                options.time);
  runtime::save_embedding(options.out, fit.embedding, key);
  if (!common.json.empty())
    write_file(common.json, json_of(options, fit, timer.seconds()).dump(2) + "\n");
  return summary(options, fit);
}

}  // namespace lte::train
