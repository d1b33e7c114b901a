#include "experiments/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "experiments/stability/stress_answers.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/cli/assets.h"
#include "lte/runtime/device.h"

namespace lte::experiments {

namespace {

constexpr Bound kExact{Figure::Max, 0};
constexpr float kTwoTo20 = 1048576, kTwoTo10 = 1024;
constexpr uint64_t kShuffle = 11;
/// Bounds of a row's two answers.
struct Bounds2 {
  Bound paths, network;
};

/// The rows in the making.
class Measurement {
 public:
  Measurement(const StabilityOptions& options)
      : options_(options),
        network_(checkpoint_or_shipped(options.checkpoint), {.device = options.device}),
        questions_(options.quick ? ask_stress_room(200, 64, 0) : ask_stress_room(2'000, 256, 0)) {
    run({}, {});  // warms up
    base_ = run({}, {});
  }

  std::vector<StabilityRow> rows() {
    noise();
    triangles();
    radiance();
    lengths();
    surfaces();
    luminaires();
    arithmetic();
    order();
    return std::move(rows_);
  }

 private:
  StressAnswers run(const StressRoom& room, const StressVariation& variation) const {
    return answer(room, questions_, network_, variation);
  }

  void add(const std::string& group, const std::string& name, const std::string& what,
           const std::string& against, const Change& change, const Bound& bound,
           const StressAnswers& answers) {
    const WorkTime& time = what == "paths" ? answers.paths_time : answers.network_time;
    rows_.push_back({group, name, what, against, change, bound, time.wall, time.processor,
                     answers.bvh.wall, answers.triangles});
    log_info(group, ", ", name, ": ", what, " ", rows_.back().holds() ? "hold" : "BREAK",
             " their bound, ", time.wall, " s");
  }

  void add_both(const std::string& group, const std::string& name, const std::string& against,
                const StressAnswers& answers, const StressAnswers& base, const Bounds2& bounds,
                double factor = 1) {
    if (!answers.paths.empty()) {
      add(group, name, "paths", against, compare(answers.paths, base.paths, factor), bounds.paths,
          answers);
    }
    if (!answers.network.empty()) {
      add(group, name, "network", against, compare(answers.network, base.network, factor),
          bounds.network, answers);
    }
  }

  /// What chance alone changes: the measure of the rows whose scene points or paths are others.
  void noise() {
    const StressAnswers other = run({}, {.seed = 1});
    add_both("noise", "another seed", "the room", other, base_, {});
    paths_noise_ = rows_[0].change.mean;
    network_noise_ = rows_[1].change.mean;
  }

  /// Cuts surfaces into smaller triangles. Scene points lie elsewhere then, as of another seed.
  void triangles() {
    std::vector<int64_t> counts = {options_.triangles / 10, 3 * options_.triangles / 10,
                                   options_.triangles};
    if (options_.quick) counts = {20'000};
    for (const int64_t count : counts) {
      const StressAnswers answers = run({.triangles = count}, {});
      add_both("triangles", std::to_string(answers.triangles),
               concat(base_.triangles, " triangles"), answers, base_,
               {{Figure::Mean, paths_noise_}, another_draw()});
    }
  }

  void radiance() {
    for (const auto& [name, factor] :
         {std::pair{"2^-20", 1 / kTwoTo20}, std::pair{"2^20", kTwoTo20}}) {
      add_both("radiance", name, "radiance 1", run({.radiance = factor}, {}), base_,
               {kExact, kExact}, double{factor});
    }
    for (const auto& [name, factor] : {std::pair{"1e-6", 1e-6F}, std::pair{"1e6", 1e6F}}) {
      add_both("radiance", name, "radiance 1", run({.radiance = factor}, {}), base_, rounding(),
               double{factor});
    }
  }

  /// Irradiance does not change with the unit of length. The network sees metres, so a smaller
  /// room is another one to it; a wider one than it knows is shrunk, whatever its size.
  void lengths() {
    const double known = network_.config().scale;
    float wide = 1;
    while (6 * double{wide} <= known) wide *= 2;
    const StressAnswers shrunk = run({.scale = wide}, {});
    const std::string against = concat(6 * wide, " m, shrunk to ", known, " m");
    add_both("unit", concat(6 * wide, " m"), "6 m", shrunk, base_, {kExact, {}});
    add_wide("1024 units a metre", {.scale = kTwoTo10}, shrunk, against, {kExact, kExact});
    // Rounded corners change areas by 1e-7. A scene point's place follows from the area before it,
    // and its distance from there by the root of it: millimetres in this room. So the network is
    // given other points, and its answers may change as much as by another seed.
    const Bounds2 rounded{rounding().paths, {Figure::Mean, network_noise_}};
    add_wide("100 units a metre: centimetres", {.scale = 100}, shrunk, against, rounded);
    add_wide("1000 units a metre: 6 km", {.scale = 1000}, shrunk, against, rounded);
    add_both("unit", "1/128 unit a metre: 5 cm", "6 m", run({.scale = 1.0F / 128}, {}), base_,
             {kExact, {}});
    add_both("unit", "1/100 unit a metre", "6 m", run({.scale = 0.01F}, {}), base_,
             {rounding().paths, {}});
    add_both("place", "1 km from the origin", "at the origin", run({.offset = {1000, 0, 0}}, {}),
             base_, {{Figure::Mean, 0.02}, another_draw()});
  }

  void add_wide(const std::string& name, const StressRoom& room, const StressAnswers& shrunk,
                const std::string& against, const Bounds2& bounds) {
    const StressAnswers answers = run(room, {});
    add("unit", name, "paths", "6 m", compare(answers.paths, base_.paths), bounds.paths, answers);
    add("unit", name, "network", against, compare(answers.network, shrunk.network), bounds.network,
        answers);
  }

  /// A network that is told of emission alone takes its unit from the mean emission of the area,
  /// which is half as much where every surface is there twice: no bound holds it.
  void surfaces() {
    const Bound twice = network_.light_request().depth > 0 ? another_draw() : Bound{};
    add_both("surfaces", "each twice in one place", "each once", run({.coincident = true}, {}),
             base_, {{Figure::Mean, paths_noise_}, twice});
    add_both("surfaces", "triangles without area between", "none", run({.degenerate = true}, {}),
             base_, {kExact, kExact});
    add_both("surfaces", "strips of 1/4096", "two triangles a side", run({.slivers = true}, {}),
             base_, {{Figure::Mean, paths_noise_}, another_draw()});
  }

  /// Cuts the lamp into equal parts. Each is sampled by itself, so paths differ as of another seed.
  /// The network has a scene point of each: where these are many, it is told less of the rest, and
  /// its answer is another one.
  void luminaires() {
    std::vector<int> counts = {10, 100, 1'000};
    if (!options_.quick) counts.push_back(10'000);
    for (const int count : counts) {
      const bool few = int64_t{8} * count <= network_.metadata().scene_points;
      add_both("lights", std::to_string(count), "1 light, as bright",
               run({.luminaires = count}, {}), base_,
               {{Figure::Mean, 3 * paths_noise_}, few ? another_draw() : Bound{}});
    }
  }

  void arithmetic() {
    const runtime::Network half(checkpoint_or_shipped(options_.checkpoint),
                                {.device = options_.device, .precision = nn::Precision::Bf16});
    const StressAnswers rounded = answer({}, questions_, half, {.paths = false});
    add_both("arithmetic", "bf16", "fp32", rounded, base_, {{}, {Figure::Mean, 0.02}});
    if (!options_.device.is_cpu()) {
      const runtime::Network on_cpu(checkpoint_or_shipped(options_.checkpoint));
      const StressAnswers right = answer({}, questions_, on_cpu, {.paths = false});
      add_both("arithmetic", "GPU", "processor", base_, right, {{}, {Figure::Mean, 1e-4}});
    }
    const int threads = num_threads();
    set_threads(1);
    const StressAnswers alone = run({}, {});
    set_threads(std::max(2, threads));
    const StressAnswers several = run({}, {});
    set_threads(threads);
    add_both("arithmetic", concat(std::max(2, threads), " threads"), "1 thread", several, alone,
             {kExact, {Figure::Max, 1e-5}});
  }

  static void set_threads(int threads) {
    set_num_threads(threads);
    runtime::set_torch_threads(threads);
  }

  void order() {
    const StressAnswers shuffled = run({}, {.edit = shuffle, .paths = false});
    add_both("order", "scene points shuffled", "as drawn", shuffled, base_, {{}, kExact});
    const StressAnswers reversed = run({}, {.reverse_queries = true, .paths = false});
    add_both("order", "queries from last to first", "first to last", reversed, base_,
             {{}, {Figure::Max, 1e-5}});
  }

  static void shuffle(embed::LitSamples* lit) {
    std::vector<size_t> order(lit->surface.position.size());
    std::iota(order.begin(), order.end(), size_t{0});
    Rng rng(kShuffle);
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
    const auto apply = [&order](auto* values) {
      const size_t each = values->size() / order.size();  // errors have one of each side
      auto moved = *values;
      for (size_t i = 0; i < each * order.size(); ++i)
        moved[i] = (*values)[each * order[i / each] + i % each];
      *values = std::move(moved);
    };
    scene::SurfaceSamples& s = lit->surface;
    apply(&s.position);
    apply(&s.normal);
    apply(&s.albedo);
    apply(&s.emission);
    apply(&s.gloss);
    apply(&s.area);
    apply(&s.light_group);
    apply(&lit->light.direct);
    apply(&lit->light.indirect);
    apply(&lit->light.direct_back);
    apply(&lit->light.indirect_back);
    apply(&lit->light.error);
  }

  /// The network may change by three times what another draw of its points and paths does.
  Bound another_draw() const { return {Figure::Mean, 3 * network_noise_}; }
  /// A factor that is no power of two rounds every number once more, and few paths then meet
  /// something else.
  static Bounds2 rounding() { return {{Figure::Mean, 1e-4}, {Figure::Mean, 1e-4}}; }

  const StabilityOptions& options_;
  runtime::Network network_;
  StressQuestions questions_;
  StressAnswers base_;
  double paths_noise_ = 0, network_noise_ = 0;
  std::vector<StabilityRow> rows_;
};

}  // namespace

double Change::of(Figure figure) const {
  switch (figure) {
    case Figure::Shift:
      return std::abs(shift);
    case Figure::Mean:
      return mean;
    case Figure::Max:
      return most;
    case Figure::None:
      break;
  }
  return 0;
}

Change compare(std::span<const Rgb> answers, std::span<const Rgb> base, double factor) {
  LTE_CHECK(answers.size() == base.size(), "stability: ", answers.size(), " answers against ",
            base.size());
  const std::span<const float> a = runtime::floats(answers), b = runtime::floats(base);
  Change out;
  out.values = static_cast<int64_t>(a.size());
  double sum = 0, size = 0, signed_sum = 0;
  std::vector<double> differences;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) {
      ++out.non_finite;
      continue;
    }
    const double difference = double{a[i]} / factor - double{b[i]};
    differences.push_back(std::abs(difference));
    signed_sum += difference;
    sum += std::abs(difference);
    size += std::abs(double{b[i]});
  }
  if (differences.empty() || size == 0) return out;
  const auto count = static_cast<double>(differences.size());
  const double mean = size / count;
  std::sort(differences.begin(), differences.end());
  out.shift = signed_sum / size;
  out.mean = sum / size;
  out.p99 = differences[static_cast<size_t>(0.99 * (count - 1))] / mean;
  out.most = differences.back() / mean;
  return out;
}

std::vector<StabilityRow> measure_stability(const StabilityOptions& options) {
  return Measurement(options).rows();
}

}  // namespace lte::experiments
