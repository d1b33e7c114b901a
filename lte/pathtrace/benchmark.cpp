#include "lte/pathtrace/benchmark.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "lte/base/parallel.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

struct LoggedRay {
  Vec3 origin, direction;
  float t_max;  ///< negative marks a nearest-hit query
};

struct RayLog {
  void nearest(const Vec3& origin, const Vec3& direction) {
    rays.push_back({origin, direction, -1});
  }
  void shadow(const Vec3& origin, const Vec3& direction, float t_max) {
    rays.push_back({origin, direction, t_max});
  }
  std::vector<LoggedRay> rays;
};

/// Bare calls; the sum keeps the compiler from dropping them.
int64_t replay(RTCScene top, const std::vector<RayLog>& logs) {
  std::atomic<int64_t> hits{0};
  parallel_for(static_cast<int64_t>(logs.size()), 4, [&](int64_t begin, int64_t end) {
    int64_t found = 0;
    for (int64_t i = begin; i < end; ++i) {
      for (const LoggedRay& ray : logs[static_cast<size_t>(i)].rays) {
        if (ray.t_max < 0) {
          RTCRayHit hit;
          found += intersect(top, ray.origin, ray.direction, &hit) ? 1 : 0;
        } else {
          found += occluded(top, ray.origin, ray.direction, ray.t_max) ? 1 : 0;
        }
      }
    }
    hits += found;
  });
  return hits;
}

template <typename Body>
double best_seconds(double budget, const Body& body) {
  double best = INFINITY;
  const Timer all;
  do {
    const Timer timer;
    body();
    best = std::min(best, timer.seconds());
  } while (all.seconds() < budget);
  return best;
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

TraceRates measure_trace_rates(const Bvh& bvh, const Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const IrradianceOptions& options, double seconds) {
  TraceRates rates;
  const double path_seconds = best_seconds(seconds, [&] {
    rates.rays = estimate_irradiance(bvh, lights, positions, normals, options).rays_traced;
  });
  std::vector<RayLog> logs(positions.size());
  run_irradiance(bvh, lights, positions, normals, options, 0,
                 [&logs](int64_t i) -> RayLog& { return logs[static_cast<size_t>(i)]; });
  std::atomic<int64_t> hits{0};
  const double bare_seconds =
      best_seconds(seconds, [&] { hits += replay(bvh.handles().top, logs); });
  const auto count = static_cast<double>(rates.rays);
  rates.path_rays_per_s = count / path_seconds;
  rates.bare_rays_per_s = count / bare_seconds;
  return rates;
}

}  // namespace lte::pathtrace
