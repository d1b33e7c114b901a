#include "infer/probe/embedded_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "infer/probe/expected_error.h"
#include "infer/probe/gathered_probe.h"
#include "lte/base/parallel_each.h"
#include "lte/base/random.h"
#include "lte/embed/point_albedo.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/render/integrator.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

// Independent of the points, the tables and the rays.
constexpr uint64_t kPlaces = 64, kTables = 65;
/// Points at which light is gathered at most; where there are fewer than the least, places on
/// surfaces beside them.
constexpr size_t kMostMeasured = 1024, kLeastMeasured = 256;
constexpr int kMeasuredRays = 64;
/// Places whose errors a point's is expected to be like.
constexpr size_t kNeighbours = 8;
constexpr int64_t kPointsAtOnce = 256;

/// Depth 1 alone.
pathtrace::ProbeResult direct_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const scene::PointTable& points, uint64_t seed) {
  pathtrace::ProbeOptions options;
  options.rays = GatheredProbeOptions().rays;
  options.max_depth = 1;
  options.seed = seed;
  return pathtrace::probe(bvh, lights, points, options);
}

/// Places where the embedding is held against gathered light.
struct Measured {
  scene::PointTable places;
  std::vector<Rgb> answer;     ///< the embedding's
  std::vector<double> square;  ///< of the error there, relative to the unit, noise taken off
  std::vector<size_t> point;   ///< its number among those asked for; or of none of them
};

/// Some of the points, evenly, and places of the scene where they are few.
Measured measured_places(const runtime::SceneEmbedding& embedding, const scene::PointTable& points,
                         std::span<const Rgb> answers, const pathtrace::Bvh& bvh, uint64_t seed) {
  Measured out;
  const size_t count = std::min(points.size(), kMostMeasured);
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k * points.size() / count;
    out.places.position.push_back(points.position[i]);
    out.places.normal.push_back(points.normal[i]);
    out.answer.push_back(answers[i]);
    out.point.push_back(i);
  }
  if (count >= kLeastMeasured) return out;
  scene::SamplerOptions sampling;
  sampling.seed = hash_combine(seed, kPlaces);
  sampling.environment_share = 0;
  sampling.punctual_lights = false;
  const scene::SurfaceSamples drawn =
      scene::sample_surface(bvh.scene(), static_cast<int64_t>(kLeastMeasured - count), sampling);
  const std::vector<Rgb> light = embedding.decode({drawn.position, drawn.normal, drawn.albedo});
  for (size_t i = 0; i < light.size(); ++i) {
    out.places.position.push_back(drawn.position[i]);
    out.places.normal.push_back(drawn.normal[i]);
    out.answer.push_back(light[i]);
    out.point.push_back(std::numeric_limits<size_t>::max());
  }
  return out;
}

/// Fills Measured::square.
void measure(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, const gi::ErrorUnit& unit,
             uint64_t seed, Measured* measured) {
  GatheredProbeOptions options;
  options.rays = kMeasuredRays;
  options.seed = hash_combine(seed, kTables);
  const GatheredProbe gathered = gather_at(bvh, lights, measured->places, options, [&](int number) {
    render::CacheSettings cache;
    cache.seed = hash_combine(options.seed, static_cast<uint64_t>(number));
    return render::make_cache({bvh, lights}, cache);
  });
  for (size_t i = 0; i < measured->answer.size(); ++i) {
    const double apart = rms(measured->answer[i] - gathered.indirect[i]),
                 noise = rms(gathered.standard_error[i]), here = unit(rms(measured->answer[i]));
    measured->square.push_back((apart * apart - noise * noise) / (here * here));
  }
}

/// What to expect by the nearest places, but for the point itself.
double square_around(const Measured& measured, const Vec3& position, size_t point) {
  using Place = std::pair<float, double>;  // distance and square
  std::array<Place, kNeighbours> nearest;
  size_t count = 0;
  for (size_t k = 0; k < measured.square.size(); ++k) {
    if (measured.point[k] == point) continue;
    const Vec3 way = measured.places.position[k] - position;
    const Place place{dot(way, way), measured.square[k]};
    if (count == kNeighbours && !(place < nearest.back())) continue;
    size_t at = count < kNeighbours ? count++ : kNeighbours - 1;
    for (; at > 0 && place < nearest[at - 1]; --at) nearest[at] = nearest[at - 1];
    nearest[at] = place;
  }
  double sum = 0;
  for (size_t k = 0; k < count; ++k) sum += nearest[k].second;
  return std::max(0.0, sum / static_cast<double>(std::max<size_t>(1, count))) +
         gi::kSharedError * gi::kSharedError;
}

std::vector<double> errors_of(const runtime::SceneEmbedding& embedding,
                              const scene::PointTable& points, std::span<const Rgb> answers,
                              std::span<const Rgb> direct_error, const pathtrace::Bvh& bvh,
                              const pathtrace::Lights& lights, uint64_t seed) {
  Measured measured = measured_places(embedding, points, answers, bvh, seed);
  const gi::ErrorUnit unit = error_unit(measured.answer);
  measure(bvh, lights, unit, seed, &measured);
  const std::vector<uint8_t> lit =
      pathtrace::reached(bvh, points.position, points.normal, pathtrace::Sides::Front, {});
  std::vector<double> out(points.size());
  parallel_each(points.size(), kPointsAtOnce, [&](size_t i) {
    const double here = unit(rms(answers[i]));
    // What a network says of the inside of a cupboard is an error, and places around it are none.
    out[i] = lit[i] == 0 ? rms(answers[i])
                         : std::sqrt(square_around(measured, points.position[i], i) * here * here +
                                     std::pow(rms(direct_error[i]), 2));
  });
  return out;
}

}  // namespace

EmbeddedLight embedded_light(const runtime::SceneEmbedding& embedding,
                             const scene::PointTable& points, std::span<const Rgb> albedo,
                             const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const EmbeddedLightOptions& options) {
  EmbeddedLight out{embedding.decode({points.position, points.normal, albedo}), {}};
  if (points.position.empty()) return out;
  std::vector<Rgb> direct(points.size()), direct_error(points.size());
  if (options.direct) {
    pathtrace::ProbeResult traced = direct_light(bvh, lights, points, options.seed);
    direct = std::move(traced.direct);
    direct_error = std::move(traced.standard_error);
  }
  if (options.error)
    out.expected_error =
        errors_of(embedding, points, out.irradiance, direct_error, bvh, lights, options.seed);
  for (size_t i = 0; i < direct.size(); ++i) out.irradiance[i] += direct[i];
  return out;
}

}  // namespace lte::infer
