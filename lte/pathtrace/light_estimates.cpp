#include "lte/pathtrace/light_estimates.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::pathtrace {
namespace {

/// Points between two calls of LightEstimateOptions::check.
constexpr size_t kCheckedBlock = 512;

/// Where a point lies, and what it was in the arrays of all points.
struct LitPoints {
  std::vector<size_t> slots;
  std::vector<Vec3> place, up, down;
};

LitPoints points_without_emission(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                  std::span<const Rgb> emission) {
  LitPoints points;
  for (size_t i = 0; i < positions.size(); ++i) {
    if (max_component(emission[i]) > 0) continue;
    points.slots.push_back(i);
    points.place.push_back(positions[i]);
    points.up.push_back(normals[i]);
    points.down.push_back(-normals[i]);
  }
  return points;
}

/// At most 1: no values that are not negative spread more than their mean.
float relative_error(float variance, const Rgb& mean) {
  const float gray = (mean.x + mean.y + mean.z) / 3;
  return gray > 0 ? std::min(1.0f, std::sqrt(variance) / gray) : 0.0f;
}

}  // namespace

LightEstimates estimate_light(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                              std::span<const Vec3> normals, std::span<const Rgb> emission,
                              const LightEstimateOptions& options) {
  LTE_CHECK(emission.size() == positions.size(), "light estimates: ", positions.size(),
            " positions but ", emission.size(), " emissions");
  const LitPoints lit = points_without_emission(positions, normals, emission);
  const size_t G = static_cast<size_t>(lights.groups()), M = positions.size(), S = lit.slots.size();
  const std::vector<Rgb> dark(G * M);
  const std::vector<float> exact(G * M);
  LightEstimates light{dark, dark, dark, dark, exact, exact};
  if (lit.slots.empty()) return light;
  IrradianceOptions tracing;
  tracing.rays = options.paths;
  tracing.max_depth = options.max_depth;
  tracing.group_variance = true;
  const size_t block = options.check ? kCheckedBlock : S;
  for (const bool back : {false, true}) {
    tracing.seed = hash_combine(options.seed, back ? 1 : 0);
    std::vector<float>& error = back ? light.error_back : light.error;
    for (size_t first = 0; first < S; first += block) {
      if (options.check) options.check();
      const size_t count = std::min(block, S - first);
      const Irradiance side =
          estimate_irradiance(bvh, lights, std::span(lit.place).subspan(first, count),
                              std::span(back ? lit.down : lit.up).subspan(first, count), tracing,
                              static_cast<int64_t>(first));
      for (size_t g = 0; g < G; ++g) {
        for (size_t i = 0; i < count; ++i) {
          const size_t from = g * count + i, to = g * M + lit.slots[first + i];
          light.direct[to] += side.direct[from];
          light.indirect[to] += side.indirect[from];
          error[to] = relative_error(side.group_variance[from], side.indirect[from]);
          if (!back) continue;
          light.direct_back[to] = side.direct[from];
          light.indirect_back[to] = side.indirect[from];
        }
      }
    }
  }
  return light;
}

}  // namespace lte::pathtrace
