// Final gather over an irradiance cache (Ward et al., "A ray tracing solution for diffuse
// interreflection", 1988; final gathering as Jensen, "Realistic image synthesis", 1996, has it).
//
// Some thousand records on the surfaces know the irradiance there: by paths that are traced from
// them ("gather"), or because a network says so ("network", which then needs sampled direct light
// at the records alone). A ray from the point that is computed meets a surface and reads the
// records around the hit, times the albedo there, instead of becoming a path of its own. Direct
// light is sampled apart, by light samples and the same rays, weighed by the balance heuristic
// (Veach and Guibas 1995).
//
// A share of the rays is aimed at records that are small and bright (lte/gi/bright_places.h). One
// ray carries as much as three or four paths. What the records do not know is lost to the ray
// and not to the picture: where too few stand around a hit, where they differ by more than smooth
// light would, along metal and near corners the ray goes on as a path.
//
// It fails where the records' light is wrong over a wide area: light that only few bright paths
// find (a slit, a lamp around two corners) makes blotches of the size of what a ray sees, which
// more rays do not cure; more records and paths from them do, and so do the picture's own paths
// (combine.h). A network's records take their level from the scene and are reflected twice by
// gathered rays (lte/gi/network_light_level.h); what is left of its error is smooth.
#include "lte/gi/gather.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/gi/cache_records.h"
#include "lte/gi/network_light_level.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/render/gathered_points.h"
#include "lte/render/integrator.h"

namespace lte::render {
namespace {

// Bytes a record: what it is made from, its light and walls, and its places in the index, which
// lists it in every cell that it speaks for.
constexpr double kRecordBytes = 2048;
// Estimates of a record and a light group, of as many as are made at once.
constexpr double kEstimateBytes = 36, kMaxEstimates = 1 << 21;
// Records draw other numbers than pixels.
constexpr uint64_t kPlaces = 21, kLight = 22;

class Gather : public Integrator {
 public:
  Gather(const TracedScene& scene, const CacheSettings& settings, IrradianceSource source)
      : scene_(scene), settings_(settings), source_(std::move(source)) {}
  Gather(const TracedScene& scene, std::shared_ptr<const gi::IrradianceCache> cache, int max_depth,
         Method method)
      : scene_(scene), cache_(std::move(cache)), given_(method) {
    settings_.max_depth = max_depth;
  }

  Method method() const override { return source_ ? Method::Network : given_; }

  void prepare() override {
    if (!cache_)
      cache_ = std::make_shared<const gi::IrradianceCache>(make_cache(scene_, settings_, source_));
  }

  PointIrradiance irradiance(const SurfacePoints& points,
                             const PointSampling& sampling) const override {
    LTE_CHECK(cache_ != nullptr, "gather: prepare() comes before irradiance()");
    return gather_points(scene_, *cache_, points, sampling, settings_.max_depth);
  }

 private:
  TracedScene scene_;
  CacheSettings settings_;
  IrradianceSource source_;
  std::shared_ptr<const gi::IrradianceCache> cache_;
  Method given_ = Method::Gather;
};

}  // namespace

gi::IrradianceCache make_cache(const TracedScene& scene, const CacheSettings& settings,
                               const IrradianceSource& source) {
  LTE_CHECK(settings.paths >= 1, "an irradiance cache needs a path a record, got ", settings.paths);
  const auto& [bvh, lights] = scene;
  const uint64_t places = hash_combine(settings.seed, kPlaces);
  // A gather adds a bounce to the records' light, so light of depth 1 is all that none has.
  if (!source && (lights.empty() || settings.max_depth < 2)) return {bvh, {}, {}};
  const gi::CacheRecords records = gi::sample_records(bvh, settings.records, places);
  const int depth = source ? 1 : settings.max_depth - 1;
  const gi::RecordLight light =
      gi::estimate_records(bvh, lights, records, settings.paths, depth,
                           source ? places : hash_combine(settings.seed, kLight));
  auto geometry = std::make_shared<const gi::CacheGeometry>(bvh, records);
  return source ? make_cache(scene, settings, geometry, records, light, source)
                : gi::IrradianceCache::of(std::move(geometry), records, light);
}

gi::IrradianceCache make_cache(const TracedScene& scene, const CacheSettings& settings,
                               const std::shared_ptr<const gi::CacheGeometry>& geometry,
                               const gi::CacheRecords& records, const gi::RecordLight& direct,
                               const IrradianceSource& source) {
  gi::LevelOptions options;
  options.max_depth = settings.max_depth;
  options.seed = hash_combine(settings.seed, kLight);
  return gi::level_network_light(scene.bvh, scene.lights, geometry, records, direct, source,
                                 options);
}

double cache_mb(const CacheSettings& settings, int64_t groups) {
  // As many as there are where no surface is level.
  const auto records = static_cast<double>(settings.records) * gi::kRecordPoints;
  const double estimates =
      std::min(records * static_cast<double>(std::max<int64_t>(groups, 1)), kMaxEstimates);
  return (records * kRecordBytes + estimates * kEstimateBytes) / (1 << 20);
}

PointIrradiance gather_points(const TracedScene& scene, const gi::IrradianceCache& cache,
                              const SurfacePoints& points, const PointSampling& sampling,
                              int max_depth) {
  PointIrradiance out;
  std::vector<Rgb> met;
  if (sampling.rays > 0 && max_depth < 2) {
    out.indirect.resize(points.position.size());
  } else if (sampling.rays > 0) {
    gi::GatherOptions options;
    options.rays = sampling.rays;
    options.near_hits = sampling.near_hits;
    options.together = sampling.together;
    options.max_depth = max_depth;
    options.seed = sampling.seed;
    options.numbers = sampling.ray_numbers;
    gi::Gathered gathered =
        gi::gather_irradiance(scene.bvh, scene.lights, cache, points.position, points.normal,
                              options, sampling.first_index, points.geometric_normal);
    out.indirect = std::move(gathered.indirect);
    met = std::move(gathered.met);
  }
  if (sampling.light_samples == 0) return out;
  std::vector<uint64_t> streams(sampling.light_numbers.empty() ? points.position.size() : 0);
  std::iota(streams.begin(), streams.end(), static_cast<uint64_t>(sampling.first_index));
  pathtrace::DirectOptions options;
  options.seed = sampling.seed;
  // As many rays over the hemisphere as light samples have been traced already.
  const bool both = !met.empty() && sampling.rays == sampling.light_samples;
  if (both) {
    options.hemisphere_share = 1;
    options.hemisphere_elsewhere = true;
  }
  out.direct =
      std::move(pathtrace::estimate_direct(
                    scene.bvh, scene.lights,
                    {points.position, points.normal, streams, points.geometric_normal,
                     sampling.light_numbers},
                    std::vector<int32_t>(points.position.size(), sampling.light_samples), options)
                    .irradiance);
  for (size_t i = 0; both && i < met.size(); ++i) out.direct[i] += met[i];
  return out;
}

std::unique_ptr<Integrator> make_gather(const TracedScene& scene, const CacheSettings& settings,
                                        IrradianceSource source) {
  return std::make_unique<Gather>(scene, settings, std::move(source));
}

std::unique_ptr<Integrator> make_gather(const TracedScene& scene,
                                        std::shared_ptr<const gi::IrradianceCache> cache,
                                        int max_depth, Method method) {
  LTE_CHECK(cache != nullptr, "gather: there is no irradiance cache");
  return std::make_unique<Gather>(scene, std::move(cache), max_depth, method);
}

}  // namespace lte::render
