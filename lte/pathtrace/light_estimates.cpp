#include "lte/pathtrace/light_estimates.h"

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::pathtrace {

LightEstimates estimate_light(const Bvh& bvh, const Lights& lights, std::span<const Vec3> positions,
                              std::span<const Vec3> normals, std::span<const Rgb> emission,
                              const LightEstimateOptions& options) {
  LTE_CHECK(emission.size() == positions.size(), "light estimates: ", positions.size(),
            " positions but ", emission.size(), " emissions");
  std::vector<size_t> slots;
  std::vector<Vec3> place, up, down;
  for (size_t i = 0; i < positions.size(); ++i) {
    if (max_component(emission[i]) > 0) continue;
    slots.push_back(i);
    place.push_back(positions[i]);
    up.push_back(normals[i]);
    down.push_back(-normals[i]);
  }
  const size_t G = static_cast<size_t>(lights.groups()), M = positions.size(), S = slots.size();
  LightEstimates light{std::vector<Rgb>(G * M), std::vector<Rgb>(G * M)};
  if (slots.empty()) return light;
  IrradianceOptions tracing;
  tracing.rays = options.paths;
  tracing.max_depth = options.max_depth;
  uint64_t side = 0;
  for (const std::vector<Vec3>* towards : {&up, &down}) {
    tracing.seed = hash_combine(options.seed, side++);
    const Irradiance lit = estimate_irradiance(bvh, lights, place, *towards, tracing);
    for (size_t g = 0; g < G; ++g) {
      for (size_t i = 0; i < S; ++i) {
        light.direct[g * M + slots[i]] += lit.direct[g * S + i];
        light.indirect[g * M + slots[i]] += lit.indirect[g * S + i];
      }
    }
  }
  return light;
}

}  // namespace lte::pathtrace
