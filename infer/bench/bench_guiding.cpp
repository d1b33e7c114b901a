// lte_bench guiding: the variance of indirect light with few paths a pixel, their first directions
// drawn by the material alone or by the radiance decoder's maps too (the paper's supplement,
// section 4).
#include <cmath>
#include <vector>

#include "infer/bench/bench.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/auto_camera.h"
#include "lte/pathtrace/guide.h"
#include "lte/pathtrace/hemisphere_bins.h"
#include "lte/pathtrace/incident.h"

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

/// Mean and variance of one path's indirect light towards the camera, in luminance.
struct PathStatistics {
  double mean = 0, variance = 0;
};

PathStatistics statistics_of(const pathtrace::IncidentSamples& samples,
                             const pathtrace::Guide& material) {
  double sum = 0, squares = 0;
  for (int64_t i = 0; i < samples.count; ++i) {
    const auto at = static_cast<size_t>(i);
    if (!(samples.pdf[at] > 0)) continue;
    Rgb light{};
    for (int64_t g = 0; g < samples.groups; ++g)
      light += samples.indirect[static_cast<size_t>(g * samples.count + i)];
    const double value = double{luminance(light * material.reflected(samples.direction[at]))} /
                         double{samples.pdf[at]};
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(samples.count);
  const double mean = sum / n;
  return {mean, std::max(0.0, (squares / n - mean * mean) * n / (n - 1))};
}

/// Sums over pixels of one way to draw.
struct Way {
  double mean = 0, variance = 0, seconds = 0;

  void add(const PathStatistics& pixel) {
    mean += pixel.mean;
    variance += pixel.variance;
  }
  /// Of the mean of `paths` paths, over the squared mean light of a pixel.
  BenchResult row(const std::string& name, int64_t pixels, double preparing) const {
    BenchResult out{name, pixels * kPaths, seconds, seconds, {}};
    const auto n = static_cast<double>(pixels);
    const double relative = n > 0 && mean > 0 ? (variance / n) / ((mean / n) * (mean / n)) : 0;
    for (const int paths : {2, 8, 32})
      out.figures["relative_variance_" + std::to_string(paths)] = relative / paths;
    out.figures["mean"] = n > 0 ? mean / n : 0;
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
  Way by_material, by_guide;
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
    by_guide.add(statistics_of(sampler.draw(s.position, s.normal, guide, kPaths, rng), guide));
    by_guide.seconds += timer.seconds();
    timer.restart();
    const bool metal = s.reflector.gloss.metallic > 0;
    by_material.add(statistics_of(metal
                                      ? sampler.draw(s.position, s.normal, s.reflector, kPaths, rng)
                                      : sampler.draw(s.position, s.normal, kPaths, rng),
                                  guide));
    by_material.seconds += timer.seconds();
  }
  const auto pixels = static_cast<int64_t>(sights.size());
  return {by_material.row("paths by the material", pixels, 0),
          by_guide.row("paths by the guide and the material", pixels, preparing)};
}

}  // namespace lte::infer
