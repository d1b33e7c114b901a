#include "experiments/guiding/sights.h"

#include <algorithm>

#include "lte/pathtrace/ray_offset.h"
#include "lte/scene/surface.h"

namespace lte::experiments {

std::vector<Sight> look(const pathtrace::Bvh& bvh, const scene::Camera& camera, int width,
                        int height) {
  const auto columns = static_cast<float>(width), rows = static_cast<float>(height);
  std::vector<Sight> sights;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 direction =
          camera.direction((static_cast<float>(x) + 0.5f) / columns,
                           (static_cast<float>(y) + 0.5f) / rows, columns / rows);
      const pathtrace::Hit hit = bvh.intersect({camera.origin, direction});
      if (!hit.valid()) continue;
      const scene::Surface at =
          scene::evaluate_surface(bvh.scene(), hit.instance, hit.triangle, hit.u, hit.v, 0);
      if (max_component(at.albedo) <= 0) continue;
      const Vec3 outgoing = -normalize(direction);
      const Vec3 normal = dot(at.normal, outgoing) > 0 ? at.normal : -at.normal;
      if (!(dot(normal, outgoing) > 0)) continue;
      sights.push_back({at.position, normal, {at.albedo, at.gloss, outgoing}});
    }
  }
  return sights;
}

Statistics Moments::of(int64_t count) const {
  const auto n = static_cast<double>(count);
  const double mean = sum_ / n;
  return {mean, std::max(0.0, (squares_ / n - mean * mean) * n / (n - 1))};
}

Brought brought(const IncidentSamples& samples, size_t at, const Guide& material) {
  Rgb bounced{}, direct{};
  for (int64_t g = 0; g < samples.groups; ++g) {
    const size_t slot = static_cast<size_t>(g * samples.count) + at;
    bounced += samples.indirect[slot];
    direct += samples.direct[slot];
  }
  const Rgb reflected = material.reflected(samples.direction[at]);
  const auto towards_camera = [&](const Rgb& light) {
    return double{luminance(light * reflected)} / double{samples.pdf[at]};
  };
  return {towards_camera(bounced), towards_camera(bounced + direct)};
}

PathStatistics statistics_of(const IncidentSamples& samples, const Guide& material) {
  Moments indirect, whole;
  for (size_t i = 0; i < samples.pdf.size(); ++i) {
    if (!(samples.pdf[i] > 0)) continue;
    const Brought light = brought(samples, i, material);
    indirect.add(light.indirect);
    whole.add(light.whole);
  }
  return {indirect.of(samples.count), whole.of(samples.count)};
}

Statistics light_samples(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const Sight& sight, const Guide& material, int64_t count, Rng* rng) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  const Vec3 origin = pathtrace::offset_origin(sight.position, sight.normal, half_extent);
  Moments moments;
  for (int64_t i = 0; i < count; ++i) {
    const double choice = rng->uniform();
    const Vec2 place{rng->uniform(), rng->uniform()};
    const pathtrace::LightSample drawn = lights.sample(origin, sight.normal, choice, place);
    if (!(drawn.pdf > 0) || dot(drawn.direction, sight.normal) <= 0) continue;
    constexpr float kShort = 0.999f;  // ends before the lamp itself
    if (bvh.occluded({origin, drawn.direction, 0, drawn.distance * kShort})) continue;
    moments.add(double{luminance(drawn.radiance * material.reflected(drawn.direction))} /
                double{drawn.pdf});
  }
  return moments.of(count);
}

}  // namespace lte::experiments
