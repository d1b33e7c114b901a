#include "experiments/sampling/error_gain.h"

#include <cmath>

#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::experiments {

using namespace pathtrace;

namespace {

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

}  // namespace lte::experiments
