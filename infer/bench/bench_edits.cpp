// lte_bench edits: how long a live scene takes to answer an edit, and whether many of them leave
// anything behind.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>
#include <utility>

#include "infer/bench/bench.h"
#include "infer/bench/edit_growth.h"
#include "infer/bench/encoding_reuse.h"
#include "infer/session/dimmable_picture.h"
#include "infer/session/session.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/cli/scene_flags.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

constexpr int kReferenceRays = 512;
constexpr int64_t kReferencePoints = 2000;

/// Of all threads of this process.
double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// As --quality draft, but with the noise of its shadow rays: what is shown while things move.
RenderSettings draft() {
  RenderSettings settings;
  settings.width = 640;
  settings.height = 480;
  settings.direct_samples = 4;
  settings.antialias = 0;
  settings.layers = false;
  settings.sparse.emplace();
  settings.sparse->tolerance = 0.2f;
  settings.sparse->contact_radius = -1;
  return settings;
}

SessionSettings session_settings(const BenchOptions& options) {
  SessionSettings out;
  out.embedding.scene_points = options.session_points;
  return out;
}

class EditBench {
 public:
  EditBench(scene::Scene scene, const BenchOptions& options)
      : repeats_(std::max(1, options.repeats)),
        session_(std::move(scene), runtime::Network(checkpoint_or_shipped("", kHybridModel)),
                 session_settings(options)) {
    const SessionState& state = *session_.state();
    camera_ = state.scene().cameras.empty() ? pathtrace::auto_camera(state.bvh())
                                            : state.scene().cameras.front();
    for (const LuminaireInfo& light : state.luminaires()) lights_.push_back(light.id);
    for (const InstanceInfo& info : state.instances()) {
      (info.light == scene::kNone ? objects_ : lamps_).push_back(info);
    }
    LTE_CHECK(!lights_.empty() && !objects_.empty(), state.scene().name,
              ": edits need a luminaire and an object");
    // The walls are the largest instance.
    std::sort(objects_.begin(), objects_.end(), [](const InstanceInfo& a, const InstanceInfo& b) {
      return length(a.bounds.extent()) < length(b.bounds.extent());
    });
  }

  std::vector<BenchResult> run(int random_edits) {
    compare_encodings_of_a_move();
    picture(camera_);  // warm
    measure("camera move", [&](int) { return EditReport{}; });
    measure_once("dim a lamp, the first time", [&] {
      return session_.apply(SetLight{lights_[0], 0.5, {}});
    });
    measure("dim it again", [&](int i) {
      return session_.apply(SetLight{lights_[0], 0.5 + 0.01 * (i + 1), {}}, true);
    });
    dim_a_sum();
    session_.undo();
    const InstanceInfo object = objects_[objects_.size() / 2];
    const int material = object.material;
    measure("recolour a material", [&](int i) {
      return session_.apply(SetMaterial{material, {0.5f, 0.3f, 0.01f * static_cast<float>(i)}});
    });
    measure_move("an object", object);
    if (!lamps_.empty()) measure_move("a lamp", lamps_[0]);
    compare_light();
    if (random_edits > 0)
      results_.push_back(measure_growth(&session_, camera_, draft(), random_edits));
    return std::move(results_);
  }

 private:
  void picture(const scene::Camera& camera) { session_.state()->render(camera, draft()); }

  static MoveInstance moved(const InstanceInfo& info, int step) {
    MoveInstance edit{info.id, info.to_world};
    edit.to_world.m[0][3] += 0.02f * static_cast<float>(step + 1);
    return edit;
  }

  /// Before any luminaire is apart.
  void compare_encodings_of_a_move() {
    const StatePtr before = session_.state();
    session_.apply(moved(objects_[objects_.size() / 2], 0));
    results_.push_back(compare_encodings(*before, *session_.state()));
    session_.undo();
  }

  /// All of the light at once, and step by step as lte_view has it.
  void measure_move(const std::string& what, const InstanceInfo& info) {
    measure("move " + what, [&](int i) { return session_.apply(moved(info, i)); });
    measure("move " + what + ", light of before",
            [&](int i) { return session_.apply(moved(info, 10 + i), false, Accuracy::Kept); });
    measure("move " + what + ", draft of the light", [&](int i) {
      EditReport report = session_.apply(moved(info, 20 + i), false, Accuracy::Kept);
      return report += session_.refine(Accuracy::Draft).value();
    });
    session_.refine();
  }

  /// A dimming that renders nothing, as a page's picture at rest has it.
  void dim_a_sum() {
    const RenderSettings settings = draft();
    DimmablePicture sum(session_.state(), settings.output,
                        int64_t{settings.width} * settings.height);
    StageSeconds ignored;
    Timer timer;
    sum.add(camera_, settings, /*anew=*/true, &ignored);
    BenchResult row{"dim a sum of pictures", repeats_, INFINITY, 0, {}};
    row.figures["sum_ms"] = 1e3 * timer.seconds();
    for (int i = 0; i < repeats_; ++i) {
      timer.restart();
      session_.apply(SetLight{lights_[0], 0.3 + 0.01 * i, {}}, true);
      sum.color(*session_.state());
      row.seconds_min = std::min(row.seconds_min, timer.seconds());
    }
    row.seconds_median = row.seconds_min;
    results_.push_back(std::move(row));
  }

  struct Sample {
    double edit_s = 0, picture_s = 0, processor_s = 0;
    EditReport report;
  };

  Sample sample(const std::function<EditReport()>& edit, int step) {
    Sample out;
    scene::Camera camera = camera_;
    camera.origin.y += 0.01f * static_cast<float>(step);
    const double before = processor_seconds();
    const Timer timer;
    out.report = edit();
    out.edit_s = timer.seconds();
    picture(camera);
    out.picture_s = timer.seconds() - out.edit_s;
    out.processor_s = processor_seconds() - before;
    return out;
  }

  void add(const std::string& name, std::vector<Sample> samples) {
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
      return a.edit_s + a.picture_s < b.edit_s + b.picture_s;
    });
    const Sample& least = samples.front();
    const Sample& median = samples[samples.size() / 2];
    BenchResult row{name,
                    static_cast<int64_t>(samples.size()),
                    least.edit_s + least.picture_s,
                    median.edit_s + median.picture_s,
                    {}};
    row.figures["edit_ms"] = 1e3 * least.edit_s;
    row.figures["picture_ms"] = 1e3 * least.picture_s;
    row.figures["processor_s"] = least.processor_s;
    row.figures["scene_ms"] = least.report.scene_ms + least.report.bvh_ms;
    row.figures["points_ms"] = least.report.points_ms;
    row.figures["light_ms"] = least.report.light_ms;
    row.figures["encode_ms"] = least.report.encode_ms;
    results_.push_back(std::move(row));
  }

  void measure(const std::string& name, const std::function<EditReport(int)>& edit) {
    std::vector<Sample> samples;
    for (int i = 0; i < repeats_; ++i) samples.push_back(sample([&] { return edit(i); }, i));
    add(name, std::move(samples));
  }

  void measure_once(const std::string& name, const std::function<EditReport()>& edit) {
    add(name, {sample(edit, 0)});
  }

  /// One encoding of all light, one a luminaire, and the draft behind a move, against paths.
  void compare_light() {
    session_.apply(moved(objects_[objects_.size() / 2], 30), false, Accuracy::Kept);
    const StatePtr state = session_.state();
    scene::SamplerOptions sampler;
    sampler.seed = 11;
    const scene::SurfaceSamples points =
        scene::sample_surface(state->scene(), kReferencePoints, sampler);
    const runtime::QueryPoints queries{points.position, points.normal, points.albedo};
    session_.refine(Accuracy::Draft);
    const std::vector<Rgb> drafted = session_.state()->irradiance(queries);
    session_.refine();
    const std::vector<Rgb> together = session_.state()->irradiance(queries);
    session_.separate();
    const std::vector<Rgb> apart = session_.state()->irradiance(queries);
    pathtrace::IrradianceOptions tracing;
    tracing.rays = kReferenceRays;
    const pathtrace::Lights lights(state->scene());
    const pathtrace::Irradiance reference = pathtrace::estimate_irradiance(
        state->bvh(), lights, points.position, points.normal, tracing);
    const auto error = [&](const auto& a, const auto& b) {
      double difference = 0, norm = 0;
      for (int64_t i = 0; i < points.size(); ++i) {
        const Rgb p = a(i), q = b(i);
        difference += dot(p - q, p - q);
        norm += dot(q, q);
      }
      return norm > 0 ? std::sqrt(difference / norm) : 0;
    };
    const auto of = [](const std::vector<Rgb>& values) {
      return [&values](int64_t i) { return values[static_cast<size_t>(i)]; };
    };
    const auto traced = [&](int64_t i) { return reference.indirect_sum(i); };
    BenchResult row{"indirect light, relative RMS", points.size(), 0, 0, {}};
    row.figures["together_vs_paths"] = error(of(together), traced);
    row.figures["apart_vs_paths"] = error(of(apart), traced);
    row.figures["draft_vs_paths"] = error(of(drafted), traced);
    row.figures["apart_vs_together"] = error(of(apart), of(together));
    row.figures["draft_vs_together"] = error(of(drafted), of(together));
    results_.push_back(std::move(row));
  }

  int repeats_;
  Session session_;
  scene::Camera camera_;
  std::vector<int> lights_;
  std::vector<InstanceInfo> objects_, lamps_;
  std::vector<BenchResult> results_;
};

}  // namespace

std::vector<BenchResult> bench_edits(const BenchOptions& options) {
  scene::Scene scene =
      load_scene(options.scene.empty() ? asset_path("scenes/living_room.glb", "--scene")
                                       : std::filesystem::path(options.scene),
                 options.loading);
  return EditBench(std::move(scene), options).run(options.random_edits);
}

}  // namespace lte::infer
