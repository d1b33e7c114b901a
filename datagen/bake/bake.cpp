#include "datagen/bake/bake.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>

#include "datagen/bake/bake_incident.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/cli/progress.h"
#include "lte/pathtrace/adaptive.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/sampler.h"
#include "lte/scene/surface.h"

namespace lte::datagen {
namespace {

constexpr int64_t kBlock = 4096;     // points between two looks at the progress
constexpr int kPathTracedRays = 64;  // of path_traced_64

/// The random streams of one scene, each with a seed of its own. The numbers are part of what makes
/// a data set reproducible: append, never reorder.
enum class Stream : uint64_t {
  ScenePoints = 1,
  QueryPoints,
  Queries,
  QueriesPathTraced64,
  View,
  Reach,
  Cameras,
  IncidentPoints,
  Incident,
  LightEstimates
};

uint64_t stream_seed(uint64_t seed, Stream stream, int64_t index = 0) {
  return hash_combine(hash_combine(seed, static_cast<uint64_t>(stream)),
                      static_cast<uint64_t>(index));
}

void in_range(const char* key, double value, double low, double high) {
  LTE_CHECK(value >= low && value <= high, key, ": expected a value in [", low, ", ", high,
            "], got ", value);
}

/// Path-traces points of one scene in blocks.
class Baker {
 public:
  Baker(const scene::Scene& scene, const BakeOptions& options, bool show_progress)
      : options_(options), bvh_(scene), lights_(scene), show_progress_(show_progress) {}

  /// The paths that follow are those of `what`, so that each rate is of one kind of work: --rays
  /// says nothing about views.
  /// @param total  their number; 0 if it is not known
  void begin(const char* what, int64_t total) {
    if (show_progress_)
      progress_.emplace(concat("baking ", bvh_.scene().name, ", ", what), total, "paths");
  }

  const pathtrace::Bvh& bvh() const { return bvh_; }
  const pathtrace::Lights& lights() const { return lights_; }
  int groups() const { return lights_.groups(); }

  /// Irradiance at points. Point i goes to slot `slots[i]` of arrays of `slot_count`, or to slot i
  /// if `slots` is empty.
  void irradiance(const std::vector<Vec3>& position, const std::vector<Vec3>& normal, int64_t rays,
                  uint64_t seed, const std::vector<size_t>& slots, size_t slot_count,
                  std::vector<Rgb>* direct, std::vector<Rgb>* indirect,
                  std::vector<float>* variance) {
    const auto G = static_cast<size_t>(groups());
    direct->assign(G * slot_count, {});
    indirect->assign(G * slot_count, {});
    variance->assign(slot_count, 0);
    in_blocks(position, normal, irradiance_options(rays, seed),
              [&](const pathtrace::Irradiance& block, size_t first) {
                const auto P = static_cast<size_t>(block.points);
                for (size_t i = 0; i < P; ++i) {
                  const size_t slot = slots.empty() ? first + i : slots[first + i];
                  (*variance)[slot] = block.variance[i];
                  for (size_t g = 0; g < G; ++g) {
                    (*direct)[g * slot_count + slot] = block.direct[g * P + i];
                    (*indirect)[g * slot_count + slot] = block.indirect[g * P + i];
                  }
                }
              });
  }

  /// Paths started so far.
  int64_t paths() const { return paths_; }

  /// Irradiance at the query points with as many paths a point as target_error asks for.
  void adaptive(uint64_t seed, data::SceneSample* sample) {
    pathtrace::AdaptiveOptions options;
    options.target_error = options_.target_error;
    options.min_rays = static_cast<int>(options_.min_rays);
    options.max_rays = static_cast<int>(options_.max_rays);
    options.max_depth = options_.max_depth;
    options.seed = seed;
    pathtrace::AdaptiveIrradiance estimate =
        pathtrace::estimate_adaptive(bvh_, lights_, sample->query_position, sample->query_normal,
                                     options, [this](int64_t paths) { count(paths); });
    sample->direct = std::move(estimate.irradiance.direct);
    sample->indirect = std::move(estimate.irradiance.indirect);
    sample->variance = std::move(estimate.irradiance.variance);
    sample->query_rays = std::move(estimate.rays);
    sample->rays = estimate.irradiance.rays;
    sample->target_error = options_.target_error;
  }

  /// Indirect irradiance of all groups together with few rays, independent of the reference: what
  /// path_traced_64 and its siblings hold.
  std::vector<Rgb> path_traced(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                               int rays, uint64_t seed, const std::vector<size_t>& slots,
                               size_t slot_count) {
    std::vector<Rgb> out(slot_count);
    pathtrace::IrradianceOptions few = irradiance_options(rays, seed);
    few.variance = false;
    in_blocks(position, normal, few, [&](const pathtrace::Irradiance& block, size_t first) {
      for (int64_t i = 0; i < block.points; ++i) {
        const size_t at = first + static_cast<size_t>(i);
        out[slots.empty() ? at : slots[at]] = block.indirect_sum(i);
      }
    });
    return out;
  }

  void count(int64_t paths) {
    paths_ += paths;
    if (progress_) progress_->advance(paths);
  }

 private:
  pathtrace::IrradianceOptions irradiance_options(int64_t rays, uint64_t seed) const {
    pathtrace::IrradianceOptions options;
    options.rays = static_cast<int>(rays);
    options.max_depth = options_.max_depth;
    options.seed = seed;
    return options;
  }

  template <typename Use>
  void in_blocks(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                 const pathtrace::IrradianceOptions& options, const Use& use) {
    const auto total = static_cast<int64_t>(position.size());
    for (int64_t first = 0; first < total; first += kBlock) {
      const auto at = static_cast<size_t>(first);
      const auto size = static_cast<size_t>(std::min(kBlock, total - first));
      use(pathtrace::estimate_irradiance(bvh_, lights_, std::span(position).subspan(at, size),
                                         std::span(normal).subspan(at, size), options, first),
          at);
      count(static_cast<int64_t>(size) * options.rays);
    }
  }

  const BakeOptions& options_;
  pathtrace::Bvh bvh_;
  pathtrace::Lights lights_;
  bool show_progress_;
  std::optional<Progress> progress_;  ///< of what is being baked now
  std::atomic<int64_t> paths_{0};
};

/// Paths beside the reference's own for each query point, and for each pixel of a view.
int64_t extra_paths(const BakeOptions& options, bool view) {
  if (!options.path_tracing_64) return 0;
  int64_t few = 0;
  for (const int rays : data::kFewPaths) few += rays;
  return view ? kPathTracedRays + few : kPathTracedRays;
}

/// Draws points where light reaches them, or all over the surface.
scene::SurfaceSamples draw_points(const pathtrace::Bvh& bvh, const BakeOptions& options,
                                  int64_t count, const scene::SamplerOptions& sampler,
                                  pathtrace::Purpose purpose, int64_t* pruned) {
  const pathtrace::ReachOptions reach{
      options.max_depth, stream_seed(options.seed, Stream::Reach, static_cast<int64_t>(purpose))};
  if (!options.prune) return pathtrace::sample_turned_surface(bvh, count, sampler, reach);
  pathtrace::PruneCounts counts;
  scene::SurfaceSamples points =
      pathtrace::sample_reached_surface(bvh, count, sampler, purpose, reach, &counts);
  *pruned = counts.pruned;
  if (points.size() < count)
    log_warning(bvh.scene().name, ": light reaches so little of the surface that only ",
                points.size(), " of ", count, " points were found");
  return points;
}

bool has_metal(const scene::Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const scene::Material& material) { return material.metallic > 0; });
}

void sample_points(const pathtrace::Bvh& bvh, const BakeOptions& options, data::SceneSample* out) {
  scene::SamplerOptions sampler;
  sampler.seed = stream_seed(options.seed, Stream::ScenePoints);
  sampler.emissive_share = options.emissive_share;
  scene::SurfaceSamples points = draw_points(bvh, options, options.scene_points, sampler,
                                             pathtrace::Purpose::Scene, &out->pruned_scene_points);
  out->scene_position = std::move(points.position);
  out->scene_normal = std::move(points.normal);
  out->scene_albedo = std::move(points.albedo);
  out->scene_emission = std::move(points.emission);
  out->scene_area = std::move(points.area);
  out->scene_light.assign(points.light_group.begin(), points.light_group.end());
  if (has_metal(bvh.scene())) {
    for (const scene::Gloss& gloss : points.gloss) {
      out->scene_metallic.push_back(gloss.metallic);
      out->scene_roughness.push_back(gloss.roughness);
    }
  }

  sampler = {};
  sampler.seed = stream_seed(options.seed, Stream::QueryPoints);
  sampler.filter_footprint = false;
  sampler.punctual_lights = false;
  sampler.environment_share = 0;
  points = draw_points(bvh, options, options.query_points, sampler, pathtrace::Purpose::Queries,
                       &out->pruned_query_points);
  out->query_position = std::move(points.position);
  out->query_normal = std::move(points.normal);
  out->query_albedo = std::move(points.albedo);
}

std::vector<Half> halves(const std::vector<float>& values) {
  std::vector<Half> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), to_half);
  return out;
}

/// What networks read of the light on scene points.
void bake_light(const Baker& baker, const BakeOptions& options, data::SceneSample* out) {
  pathtrace::LightEstimates light = pathtrace::estimate_light(
      baker.bvh(), baker.lights(), out->scene_position, out->scene_normal, out->scene_emission,
      {.paths = options.light_paths,
       .max_depth = options.max_depth,
       .seed = stream_seed(options.seed, Stream::LightEstimates)});
  out->scene_direct = std::move(light.direct);
  out->scene_indirect = std::move(light.indirect);
  out->scene_direct_back = std::move(light.direct_back);
  out->scene_indirect_back = std::move(light.indirect_back);
  out->scene_error = halves(light.error);
  out->scene_error_back = halves(light.error_back);
}

void bake_incident_points(Baker* baker, const BakeOptions& options, data::SceneSample* out) {
  if (options.incident.points == 0) return;
  baker->begin("incident radiance", incident_paths(options.incident));
  scene::SamplerOptions sampler;
  sampler.seed = stream_seed(options.seed, Stream::IncidentPoints);
  sampler.filter_footprint = false;
  sampler.punctual_lights = false;
  sampler.environment_share = 0;
  int64_t pruned = 0;
  const scene::SurfaceSamples points = draw_points(baker->bvh(), options, options.incident.points,
                                                   sampler, pathtrace::Purpose::Queries, &pruned);
  out->incident = bake_incident(baker->bvh(), baker->lights(), points, options.incident,
                                options.max_depth, stream_seed(options.seed, Stream::Incident),
                                [baker](int64_t paths) { baker->count(paths); });
}

/// Returns each given camera once, from one that the seed draws, and automatic ones after them.
scene::Camera view_camera(const pathtrace::Bvh& bvh, const BakeOptions& options, int64_t index) {
  const auto given = static_cast<int64_t>(options.view_cameras.size());
  if (index >= given)
    return pathtrace::auto_camera(
        bvh, stream_seed(options.seed, Stream::View, index),
        static_cast<float>(options.views.width) / static_cast<float>(options.views.height));
  const uint64_t first = stream_seed(options.seed, Stream::Cameras) % static_cast<uint64_t>(given);
  return options
      .view_cameras[(first + static_cast<uint64_t>(index)) % static_cast<uint64_t>(given)];
}

data::View bake_view(Baker* baker, const BakeOptions& options, int64_t index) {
  const uint64_t seed = stream_seed(options.seed, Stream::View, index);
  const scene::Camera camera = view_camera(baker->bvh(), options, index);
  const pathtrace::GBuffer hits =
      pathtrace::trace_gbuffer(baker->bvh(), camera, static_cast<int>(options.views.width),
                               static_cast<int>(options.views.height));
  const size_t pixels = hits.mask.size();
  std::vector<size_t> slots;
  std::vector<Vec3> position, normal;
  for (size_t i = 0; i < pixels; ++i) {
    if (!hits.mask[i]) continue;
    slots.push_back(i);
    position.push_back(hits.position[i]);
    normal.push_back(hits.geometric(i));
  }
  data::View view;
  view.width = hits.width;
  view.height = hits.height;
  baker->irradiance(position, normal, options.views.rays, hash_combine(seed, 1), slots, pixels,
                    &view.direct, &view.indirect, &view.variance);
  if (options.path_tracing_64) {
    view.path_traced_64 =
        baker->path_traced(position, normal, kPathTracedRays, hash_combine(seed, 2), slots, pixels);
    for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
      view.path_traced_few[i] = baker->path_traced(position, normal, data::kFewPaths[i],
                                                   hash_combine(seed, 3 + i), slots, pixels);
    }
  }
  view.position.assign(hits.position.begin(), hits.position.end());
  view.normal.assign(hits.normal.begin(), hits.normal.end());
  view.albedo.assign(hits.albedo.begin(), hits.albedo.end());
  view.mask.assign(hits.mask.begin(), hits.mask.end());
  return view;
}

}  // namespace

void check_bake_options(const BakeOptions& options) {
  in_range("scene_points", static_cast<double>(options.scene_points), 1, 1e9);
  in_range("query_points", static_cast<double>(options.query_points), 1, 1e9);
  in_range("rays", static_cast<double>(options.rays), 1, 6e7);
  in_range("target_error", options.target_error, 0, 1e3);
  in_range("min_rays", static_cast<double>(options.min_rays), 2, 6e7);
  in_range("max_rays", static_cast<double>(options.max_rays), static_cast<double>(options.min_rays),
           6e7);
  in_range("max_depth", options.max_depth, 1, 1000);
  in_range("light_paths", options.light_paths, 1, 6e7);
  in_range("emissive_share", options.emissive_share, 0, 1);
  in_range("views.count", static_cast<double>(options.views.count), 0, 1000);
  in_range("views.width", static_cast<double>(options.views.width), 1, 16384);
  in_range("views.height", static_cast<double>(options.views.height), 1, 16384);
  in_range("views.rays", static_cast<double>(options.views.rays), 1, 6e7);
  in_range("incident.points", static_cast<double>(options.incident.points), 0, 1e7);
  in_range("incident.bins", static_cast<double>(options.incident.bins), 2, 1024);
  LTE_CHECK(options.incident.bins % 2 == 0, "incident.bins: expected an even number, got ",
            options.incident.bins);
  in_range("incident.samples", static_cast<double>(options.incident.samples), 1, 1e6);
}

data::SceneSample bake_scene(const scene::Scene& scene, const BakeOptions& options,
                             bool show_progress, int64_t* rays) {
  check_bake_options(options);
  data::SceneSample sample;
  sample.name = scene.name;
  sample.geometry = scene::fingerprint(scene).geometry;
  sample.seed = options.seed;
  sample.rays = options.rays;
  sample.max_depth = options.max_depth;
  const Bounds bounds = scene.bounds();
  sample.bounds_low = bounds.low;
  sample.bounds_high = bounds.high;

  Baker baker(scene, options, show_progress);
  sample_points(baker.bvh(), options, &sample);
  sample.light_groups = baker.groups();
  bake_light(baker, options, &sample);
  const size_t N = sample.query_position.size();
  const uint64_t queries = stream_seed(options.seed, Stream::Queries);
  // The number of paths that a target takes is not known in advance.
  baker.begin("query points",
              options.target_error > 0
                  ? 0
                  : options.query_points * (options.rays + extra_paths(options, false)));
  if (options.target_error > 0) {
    baker.adaptive(queries, &sample);
  } else {
    baker.irradiance(sample.query_position, sample.query_normal, options.rays, queries, {}, N,
                     &sample.direct, &sample.indirect, &sample.variance);
  }
  if (options.path_tracing_64) {
    sample.path_traced_64 =
        baker.path_traced(sample.query_position, sample.query_normal, kPathTracedRays,
                          stream_seed(options.seed, Stream::QueriesPathTraced64), {}, N);
  }
  const ViewOptions& views = options.views;
  if (views.count > 0)
    baker.begin("views", views.count * views.width * views.height *
                             (views.rays + extra_paths(options, true)));
  for (int64_t k = 0; k < views.count; ++k) sample.views.push_back(bake_view(&baker, options, k));
  bake_incident_points(&baker, options, &sample);
  if (rays != nullptr) *rays = baker.paths();
  return sample;
}

}  // namespace lte::datagen
