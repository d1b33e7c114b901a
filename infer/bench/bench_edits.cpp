// lte_bench edits: how long a live scene takes to answer an edit, and whether many of them leave
// anything behind.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>
#include <utility>

#include "infer/bench/bench.h"
#include "infer/session/session.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/process_memory.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/scene_flags.h"
#include "lte/pathtrace/auto_camera.h"
#include "lte/pathtrace/irradiance.h"
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

class EditBench {
 public:
  EditBench(scene::Scene scene, const BenchOptions& options)
      : repeats_(std::max(1, options.repeats)),
        session_(std::move(scene), runtime::Network(checkpoint_or_shipped(""))) {
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
    picture(camera_);  // warm
    measure("camera move", [&](int) { return EditReport{}; });
    measure_once("dim a lamp, the first time", [&] {
      return session_.apply(SetLight{lights_[0], 0.5, {}});
    });
    measure("dim it again", [&](int i) {
      return session_.apply(SetLight{lights_[0], 0.5 + 0.01 * (i + 1), {}}, true);
    });
    session_.undo();
    const InstanceInfo object = objects_[objects_.size() / 2];
    const int material = object.material;
    measure("recolour a material", [&](int i) {
      return session_.apply(SetMaterial{material, {0.5f, 0.3f, 0.01f * static_cast<float>(i)}});
    });
    measure("move an object", [&](int i) { return session_.apply(moved(object, i)); });
    if (!lamps_.empty())
      measure("move a lamp", [&](int i) { return session_.apply(moved(lamps_[0], i)); });
    compare_layers();
    if (random_edits > 0) measure_growth(random_edits);
    return std::move(results_);
  }

 private:
  void picture(const scene::Camera& camera) { session_.state()->render(camera, draft()); }

  static MoveInstance moved(const InstanceInfo& info, int step) {
    MoveInstance edit{info.id, info.to_world};
    edit.to_world.m[0][3] += 0.02f * static_cast<float>(step + 1);
    return edit;
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

  /// One encoding of all light, and one a luminaire, against paths.
  void compare_layers() {
    const StatePtr state = session_.state();
    scene::SamplerOptions sampler;
    sampler.seed = 11;
    const scene::SurfaceSamples points =
        scene::sample_surface(state->scene(), kReferencePoints, sampler);
    const runtime::QueryPoints queries{points.position, points.normal, points.albedo};
    const std::vector<Rgb> together = state->irradiance(queries);
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
    row.figures["apart_vs_together"] = error(of(apart), of(together));
    results_.push_back(std::move(row));
  }

  void measure_growth(int edits) {
    Rng rng(3, 0);
    const auto uniform = [&] { return static_cast<float>(rng.next_u64() >> 40) * 0x1p-24f; };
    const auto any = [&](const auto& list) -> const auto& {
      return list[static_cast<size_t>(uniform() * static_cast<float>(list.size()))];
    };
    std::vector<int> added;
    const auto random_edit = [&](int step) {
      const InstanceInfo& object = objects_[static_cast<size_t>(
          uniform() * static_cast<float>(std::max<size_t>(1, objects_.size() - 1)))];
      switch (step % 5) {
        case 0:
          session_.apply(SetLight{any(lights_), 2.0 * uniform(), {}});
          break;
        case 1:
          session_.apply(SetMaterial{object.material, {uniform(), uniform(), uniform()}});
          break;
        case 2:
          session_.apply(moved(object, static_cast<int>(10 * uniform())));
          break;
        case 3:
          if (added.size() < 5) {
            added.push_back(session_.apply(AddInstance{object.id, moved(object, 7).to_world})
                                .added_instances.at(0));
          } else {
            session_.apply(RemoveInstance{added.back()});
            added.pop_back();
          }
          break;
        default:
          session_.undo();
          session_.redo();
      }
      if (step % 10 == 0) picture(camera_);
    };
    const int warm = edits / 10;
    for (int i = 0; i < warm; ++i) random_edit(i);
    const double before = current_rss_mb();
    const Timer timer;
    const double processor = processor_seconds();
    for (int i = warm; i < edits; ++i) random_edit(i);
    const double seconds = timer.seconds() / std::max(1, edits - warm);
    BenchResult row{"random edits", edits, seconds, seconds, {}};
    row.figures["processor_s"] = (processor_seconds() - processor) / std::max(1, edits - warm);
    row.figures["rss_after_a_tenth_mb"] = before;
    row.figures["rss_at_the_end_mb"] = current_rss_mb();
    row.figures["peak_rss_mb"] = peak_rss_mb();
    row.figures["states"] = static_cast<double>(session_.memory().states);
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
