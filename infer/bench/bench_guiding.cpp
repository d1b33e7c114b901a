// lte_bench guiding: the variance of light with few paths a pixel, their first directions drawn by
// the material alone or by the radiance decoder's maps too, and direct light found by these paths
// or by light samples (the paper's supplement, section 4).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "infer/bench/bench.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/incident/guide.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/placement/auto_camera.h"

namespace lte::infer {
namespace {

constexpr int kBins = 32;
constexpr int kColumns = 24, kRows = 18;  ///< pixels that are looked at
constexpr int64_t kPaths = 1024;          ///< of each and each way of drawing

/// What a pixel sees.
struct Sight {
  Vec3 position, normal;
  pathtrace::Reflector reflector;
};

std::vector<Sight> look(const pathtrace::Bvh& bvh, const scene::Camera& camera) {
  std::vector<Sight> sights;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const Vec3 direction =
          camera.direction((static_cast<float>(x) + 0.5f) / kColumns,
                           (static_cast<float>(y) + 0.5f) / kRows, float{kColumns} / kRows);
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

std::vector<Vec3> cells_around(const Vec3& normal) {
  const Vec3 tangent = pathtrace::bin_tangent(normal), bitangent = cross(normal, tangent);
  std::vector<Vec3> out;
  for (int cell = 0; cell < kBins * kBins; ++cell) {
    const auto centre = [](int at) { return (static_cast<float>(at) + 0.5f) / kBins; };
    const Vec3 d = pathtrace::bin_direction({centre(cell % kBins), centre(cell / kBins)});
    out.push_back(tangent * d.x + bitangent * d.y + normal * d.z);
  }
  return out;
}

/// Mean and variance of what one path or one light sample brings towards the camera, in luminance.
struct Statistics {
  double mean = 0, variance = 0;

  /// Of a sum of two that are drawn apart.
  friend Statistics operator+(const Statistics& a, const Statistics& b) {
    return {a.mean + b.mean, a.variance + b.variance};
  }
};

class Moments {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
  }
  /// @param count  values, those of 0 included that nobody added
  Statistics of(int64_t count) const {
    const auto n = static_cast<double>(count);
    const double mean = sum_ / n;
    return {mean, std::max(0.0, (squares_ / n - mean * mean) * n / (n - 1))};
  }

 private:
  double sum_ = 0, squares_ = 0;
};

/// Of paths: their indirect light, and all that they find.
struct PathStatistics {
  Statistics indirect, whole;
};

PathStatistics statistics_of(const pathtrace::IncidentSamples& samples,
                             const pathtrace::Guide& material) {
  Moments indirect, whole;
  for (int64_t i = 0; i < samples.count; ++i) {
    const auto at = static_cast<size_t>(i);
    if (!(samples.pdf[at] > 0)) continue;
    Rgb bounced{}, direct{};
    for (int64_t g = 0; g < samples.groups; ++g) {
      const auto slot = static_cast<size_t>(g * samples.count + i);
      bounced += samples.indirect[slot];
      direct += samples.direct[slot];
    }
    const Rgb reflected = material.reflected(samples.direction[at]);
    const auto towards_camera = [&](const Rgb& light) {
      return double{luminance(light * reflected)} / double{samples.pdf[at]};
    };
    indirect.add(towards_camera(bounced));
    whole.add(towards_camera(bounced + direct));
  }
  return {indirect.of(samples.count), whole.of(samples.count)};
}

/// Direct light by one light sample and its shadow ray.
Statistics light_samples(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const Sight& sight, const pathtrace::Guide& material, Rng* rng) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  const Vec3 origin = pathtrace::offset_origin(sight.position, sight.normal, half_extent);
  Moments moments;
  for (int64_t i = 0; i < kPaths; ++i) {
    const double choice = rng->uniform();
    const Vec2 place{rng->uniform(), rng->uniform()};
    const pathtrace::LightSample drawn = lights.sample(origin, sight.normal, choice, place);
    if (!(drawn.pdf > 0) || dot(drawn.direction, sight.normal) <= 0) continue;
    constexpr float kShort = 0.999f;  // ends before the lamp itself
    if (bvh.occluded({origin, drawn.direction, 0, drawn.distance * kShort})) continue;
    moments.add(double{luminance(drawn.radiance * material.reflected(drawn.direction))} /
                double{drawn.pdf});
  }
  return moments.of(kPaths);
}

/// Sums over pixels of one way to draw.
struct Way {
  Statistics indirect{}, whole{};
  double seconds = 0;

  void add(const Statistics& of_indirect, const Statistics& of_whole) {
    indirect = indirect + of_indirect;
    whole = whole + of_whole;
  }
  /// Variances of the mean of some paths, over the squared mean light of a pixel.
  BenchResult row(const std::string& name, int64_t pixels, double preparing) const {
    BenchResult out{name, pixels * kPaths, seconds, seconds, {}};
    const auto n = static_cast<double>(pixels);
    const auto relative = [n](const Statistics& sum) {
      return n > 0 && sum.mean > 0 ? (sum.variance / n) / ((sum.mean / n) * (sum.mean / n)) : 0;
    };
    for (const int paths : {2, 8, 32}) {
      out.figures["relative_variance_" + std::to_string(paths)] = relative(indirect) / paths;
      out.figures["whole_variance_" + std::to_string(paths)] = relative(whole) / paths;
    }
    out.figures["mean"] = n > 0 ? indirect.mean / n : 0;
    out.figures["whole_mean"] = n > 0 ? whole.mean / n : 0;
    out.figures["preparing_seconds"] = preparing;
    return out;
  }
};

}  // namespace

std::vector<BenchResult> bench_guiding(const BenchOptions& options) {
  LTE_CHECK(!options.scene.empty() && !options.checkpoint.empty(),
            "guiding: name a scene (--scene) and a model with a radiance decoder (--checkpoint)");
  const scene::Scene scene = load_scene(options.scene, options.loading);
  const runtime::Network network(options.checkpoint);
  LTE_CHECK(network.config().predicts_radiance(), options.checkpoint,
            ": has no radiance decoder (its model.radiance_lobes is 0)");
  Renderer renderer(scene);
  EmbedSettings embedding;
  embedding.rescale = true;
  renderer.embed(network, embedding);
  const scene::Camera camera =
      scene.cameras.empty() ? pathtrace::auto_camera(renderer.bvh()) : scene.cameras.front();
  pathtrace::IncidentSampler sampler(renderer.bvh(), renderer.lights());
  Way by_material, by_material_and_lights, by_guide_and_lights;
  double preparing = 0;
  const std::vector<Sight> sights = look(renderer.bvh(), camera);
  for (size_t i = 0; i < sights.size(); ++i) {
    const Sight& s = sights[i];
    Timer timer;
    const std::vector<Rgb> map = renderer.embedding().decode_radiance(
        {{&s.position, 1}, {&s.normal, 1}, {&s.reflector.color, 1}}, cells_around(s.normal));
    const pathtrace::Guide guide(map, kBins, s.normal, s.reflector);
    preparing += timer.seconds();
    Rng rng(7, i);
    timer.restart();
    const Statistics guided =
        statistics_of(sampler.draw(s.position, s.normal, guide, kPaths, rng), guide).indirect;
    by_guide_and_lights.seconds += timer.seconds();
    timer.restart();
    const bool metal = s.reflector.gloss.metallic > 0;
    const PathStatistics plain =
        statistics_of(metal ? sampler.draw(s.position, s.normal, s.reflector, kPaths, rng)
                            : sampler.draw(s.position, s.normal, kPaths, rng),
                      guide);
    by_material.seconds += timer.seconds();
    timer.restart();
    const Statistics direct = light_samples(renderer.bvh(), renderer.lights(), s, guide, &rng);
    const double of_lights = timer.seconds();
    by_material.add(plain.indirect, plain.whole);
    by_material_and_lights.add(plain.indirect, plain.indirect + direct);
    by_guide_and_lights.add(guided, guided + direct);
    by_material_and_lights.seconds += of_lights;
    by_guide_and_lights.seconds += of_lights;
  }
  by_material_and_lights.seconds += by_material.seconds;
  const auto pixels = static_cast<int64_t>(sights.size());
  return {by_material.row("paths by the material", pixels, 0),
          by_material_and_lights.row("paths by the material, lamps by light samples", pixels, 0),
          by_guide_and_lights.row("guided paths, lamps by light samples", pixels, preparing)};
}

}  // namespace lte::infer
