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

/// Mean squared error over points and channels of estimates with seeds 1 to `repeats`, less the
/// reference's variance.
double mean_squared_error(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                          std::span<const Vec3> normals, IrradianceOptions options, int repeats,
                          const Irradiance& reference) {
  double sum = 0;
  for (int repeat = 1; repeat <= repeats; ++repeat) {
    options.seed = static_cast<uint64_t>(repeat);
    const Irradiance e = estimate_irradiance(bvh, lights, positions, normals, options);
    for (int64_t i = 0; i < e.points; ++i) {
      const Rgb d = e.indirect_sum(i) - reference.indirect_sum(i);
      sum += dot(d, d) / 3 - reference.variance[static_cast<size_t>(i)];
    }
  }
  return sum / (static_cast<double>(repeats) * static_cast<double>(positions.size()));
}

}  // namespace

std::vector<SamplingError> measure_sampling(const Bvh& bvh, const Lights& lights,
                                            std::span<const Vec3> positions,
                                            std::span<const Vec3> normals,
                                            const IrradianceOptions& options,
                                            std::span<const int> rays, int reference_rays,
                                            int repeats) {
  IrradianceOptions tracing = options;
  tracing.rays = reference_rays;
  tracing.seed = 0;
  const Irradiance reference = estimate_irradiance(bvh, lights, positions, normals, tracing);
  double mean = 0;
  for (int64_t i = 0; i < reference.points; ++i) {
    const Rgb value = reference.indirect_sum(i);
    mean += (value.x + value.y + value.z) / (3 * static_cast<double>(reference.points));
  }
  std::vector<SamplingError> out;
  for (const int count : rays) {
    tracing.rays = count;
    double error[2];
    for (const Sampling sampling : {Sampling::Random, Sampling::Sobol}) {
      tracing.sampling = sampling;
      error[sampling == Sampling::Sobol] =
          mean_squared_error(bvh, lights, positions, normals, tracing, repeats, reference);
    }
    out.push_back(
        {count, std::sqrt(error[0]) / mean, std::sqrt(error[1]) / mean, error[0] / error[1]});
  }
  return out;
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
