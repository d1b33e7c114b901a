#include "lte/pathtrace/benchmark.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <vector>

#include "lte/base/parallel.h"
#include "lte/pathtrace/ray_replay.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

/// One of the things whose times are compared.
struct Contender {
  std::function<void()> run;
  double best_seconds = INFINITY, spent_seconds = 0;
};

/// Of all threads, shared out among them: what else runs on the machine takes wall time alone.
double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / num_threads();
}

/// Turn by turn, so that a busy moment of the machine does not fall on one of them alone.
void race(double budget, std::vector<Contender>* contenders) {
  for (bool all_done = false; !all_done;) {
    all_done = true;
    for (Contender& contender : *contenders) {
      if (contender.spent_seconds >= budget) continue;
      const double start = processor_seconds();
      contender.run();
      const double seconds = std::max(processor_seconds() - start, 1e-9);
      contender.best_seconds = std::min(contender.best_seconds, seconds);
      contender.spent_seconds += seconds;
      all_done = false;
    }
  }
}

/// One way of estimating.
struct Method {
  Sampling sampling;
  LightChoice choice;
};

/// Compares two ways on the same points.
class GainMeter {
 public:
  GainMeter(const Bvh& bvh, std::span<const Vec3> positions, std::span<const Vec3> normals,
            const GainOptions& options)
      : bvh_(bvh), positions_(positions), normals_(normals), options_(options) {}

  std::vector<ErrorGain> run(const Method& before, const Method& after) {
    reference_ = estimate(after, options_.reference_rays, 0);
    double mean = 0;
    for (int64_t i = 0; i < reference_.points; ++i) {
      const Rgb value = reference_.indirect_sum(i);
      mean += (value.x + value.y + value.z) / (3 * static_cast<double>(reference_.points));
    }
    std::vector<ErrorGain> out;
    for (const int rays : options_.rays) {
      const double a = squared_error(before, rays), b = squared_error(after, rays);
      out.push_back({rays, std::sqrt(a) / mean, std::sqrt(b) / mean, a / b});
    }
    return out;
  }

 private:
  Irradiance estimate(const Method& method, int rays, int seed) const {
    const Lights lights(bvh_.scene(), method.choice);
    IrradianceOptions options;
    options.rays = rays;
    options.max_depth = options_.max_depth;
    options.seed = static_cast<uint64_t>(seed);
    options.sampling = method.sampling;
    return estimate_irradiance(bvh_, lights, positions_, normals_, options);
  }

  /// Mean over points, channels and seeds, less the reference's variance.
  double squared_error(const Method& method, int rays) const {
    double sum = 0;
    for (int repeat = 1; repeat <= options_.repeats; ++repeat) {
      const Irradiance e = estimate(method, rays, repeat);
      for (int64_t i = 0; i < e.points; ++i) {
        const Rgb d = e.indirect_sum(i) - reference_.indirect_sum(i);
        sum += dot(d, d) / 3 - reference_.variance[static_cast<size_t>(i)];
      }
    }
    return sum / (static_cast<double>(options_.repeats) * static_cast<double>(positions_.size()));
  }

  const Bvh& bvh_;
  std::span<const Vec3> positions_, normals_;
  const GainOptions& options_;
  Irradiance reference_;
};

}  // namespace

std::vector<ErrorGain> measure_stratification(const Bvh& bvh, std::span<const Vec3> positions,
                                              std::span<const Vec3> normals,
                                              const GainOptions& options) {
  return GainMeter(bvh, positions, normals, options)
      .run({Sampling::Random, LightChoice::Automatic}, {Sampling::Sobol, LightChoice::Automatic});
}

std::vector<ErrorGain> measure_light_tree(const Bvh& bvh, std::span<const Vec3> positions,
                                          std::span<const Vec3> normals,
                                          const GainOptions& options) {
  return GainMeter(bvh, positions, normals, options)
      .run({Sampling::Sobol, LightChoice::Power}, {Sampling::Sobol, LightChoice::Tree});
}

double TraceRates::best_bare_rays_per_s() const {
  double best = 0;
  for (const BareRate& rate : bare) best = std::max(best, rate.rays_per_s);
  return best;
}

TraceRates measure_trace_rates(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, double seconds) {
  TraceRates rates;
  std::vector<RayLog> logs(positions.size());
  rates.rays = run_irradiance(bvh, lights, positions, normals, options, 0, [&logs](int64_t i) {
                 return &logs[static_cast<size_t>(i)];
               }).rays_traced;
  std::vector<RayLog> sorted = logs;
  sort_rays(bvh.bounds(), &sorted);
  std::vector<Contender> contenders;
  contenders.push_back({[&] { estimate_irradiance(bvh, lights, positions, normals, options); }});
  int64_t stopped = 0;
  for (const auto* order : {&logs, &sorted}) {
    for (const EntryPoint entry : kEntryPoints) {
      rates.bare.push_back({name_of(entry), order == &sorted, 0});
      contenders.push_back(
          {[&stopped, &bvh, order, entry] { stopped += replay(bvh, *order, entry); }});
    }
  }
  race(seconds, &contenders);
  const auto rate_of = [&rates](const Contender& c) {
    return static_cast<double>(rates.rays) / c.best_seconds;
  };
  rates.path_rays_per_s = rate_of(contenders[0]);
  for (size_t i = 0; i < rates.bare.size(); ++i)
    rates.bare[i].rays_per_s = rate_of(contenders[i + 1]);
  return rates;
}

}  // namespace lte::pathtrace
