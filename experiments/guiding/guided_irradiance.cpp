#include "experiments/guiding/guided_irradiance.h"

#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "experiments/guiding/guide_maps.h"
#include "experiments/guiding/sights.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {

using namespace infer;

namespace {

constexpr int64_t kStride = 16;  ///< each so many-th point is measured
constexpr int kBins = 16;

/// Paths of an estimate, in one low-discrepancy set; and such estimates a point. The mean of
/// several sets of 256 has their variance over their number.
constexpr std::array<std::pair<int, int>, 2> kSets = {{{64, 16}, {256, 8}}};
constexpr std::array<int, 3> kPaths = {64, 256, 1024};

/// Diffuse and white, seen from above: what it reflects is irradiance over π.
Reflector white(const Vec3& normal) { return {{1, 1, 1}, {0, 1}, normal}; }

class Estimates {
 public:
  Estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
            const scene::SurfaceSamples& points)
      : bvh_(bvh), lights_(lights), points_(points) {}

  /// @param guide_of  the guide of a point; none: cosine-distributed directions
  /// @param field     that of the paths on from there; null: none
  GuidingRow measure(const std::string& name, GuidingCost cost,
                     const std::function<Guide(size_t)>& guide_of,
                     const GuideField* field = nullptr) {
    IncidentSampler sampler(bvh_, lights_, field);
    std::array<double, 2> variance{};
    double mean = 0, seconds = 0, preparing = 0;
    int64_t paths = 0, measured = 0;
    for (int64_t i = 0; i < points_.size(); i += kStride, ++measured) {
      const auto at = static_cast<size_t>(i);
      const Vec3 &position = points_.position[at], &normal = points_.normal[at];
      const double start = processor_seconds();
      std::optional<Guide> guide;
      if (guide_of) guide.emplace(guide_of(at));
      preparing += processor_seconds() - start;
      const Guide diffuse({even_, 2, normal}, normal, white(normal));
      Rng rng(3, at);
      for (size_t set = 0; set < kSets.size(); ++set) {
        const auto [count, repeats] = kSets[set];
        Moments estimates;
        for (int r = 0; r < repeats; ++r) {
          const double begin = processor_seconds();
          const IncidentSamples& drawn = guide ? sampler.draw(position, normal, *guide, count, rng)
                                               : sampler.draw(position, normal, count, rng);
          seconds += processor_seconds() - begin;
          estimates.add(statistics_of(drawn, diffuse).indirect.mean);
          paths += count;
        }
        const Statistics spread = estimates.of(repeats);
        variance[set] += spread.variance;
        mean += spread.mean / static_cast<double>(kSets.size());
      }
    }
    const auto n = static_cast<double>(measured);
    cost.tables += preparing / n;
    cost.path = seconds / static_cast<double>(paths);
    GuidingRow row{name, paths, seconds, {}};
    row.figures["mean"] = mean / n;
    add_cost(cost, &row);
    for (const int count : kPaths) {
      const double of_sets = count <= kSets[0].first
                                 ? variance[0]
                                 : variance[1] * kSets[1].first / static_cast<double>(count);
      const double relative = mean > 0 ? of_sets / n / (mean / n * mean / n) : 0;
      add_variance("", count, relative, cost.of(count, false), &row);
    }
    return row;
  }

 private:
  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  const scene::SurfaceSamples& points_;
  std::array<Rgb, 4> even_{};
};

}  // namespace

std::vector<GuidingRow> guided_irradiance(const Renderer& renderer, const GuidingOptions& options) {
  const scene::SurfaceSamples points =
      points_all_over(renderer.bvh().scene(), options.query_points);
  Estimates estimates(renderer.bvh(), renderer.lights(), points);
  std::vector<GuidingRow> rows = {
      estimates.measure("irradiance, cosine-distributed paths", {}, nullptr)};

  const auto add = [&](const std::string& name, GuidingCost cost, const GuideMaps& maps,
                       const std::vector<size_t>& map_of_point, size_t points_served, int hits = 0,
                       const JoinedPlaces* places = nullptr) {
    const SharedGuides guides(maps);
    const auto served = static_cast<double>(points_served);
    cost.prediction = maps.seconds() / served;
    cost.tables += guides.seconds() / served;
    cost.maps = static_cast<int64_t>(maps.size());
    std::optional<GuideField> field;
    if (hits > 0) field.emplace(guides.field(*places, hits));
    rows.push_back(estimates.measure(
        name, cost,
        [&](size_t i) {
          return guides.guide(map_of_point[i], points.normal[i], white(points.normal[i]));
        },
        field ? &*field : nullptr));
  };

  // A map for each of the points that are measured.
  PlaceList own;
  std::vector<size_t> own_map(points.position.size());
  for (size_t i = 0; i < own_map.size(); i += kStride) {
    own_map[i] = own.position.size();
    own.push_back(points.position[i], points.normal[i], points.albedo[i]);
  }
  add(guide_name("irradiance, guided", kBins, "a map a point"), {},
      GuideMaps::predicted(renderer.embedding(), own.view(), kBins), own_map, own.position.size());

  const double start = processor_seconds();
  JoinedPlaces shared(options.radius_m);
  std::vector<size_t> shared_map;
  for (size_t i = 0; i < points.position.size(); ++i)
    shared_map.push_back(shared.join(points.position[i], points.normal[i], points.albedo[i]));
  GuidingCost joining;
  joining.tables = (processor_seconds() - start) / static_cast<double>(shared_map.size());
  const GuideMaps maps = GuideMaps::predicted(renderer.embedding(), shared.view(), kBins);
  add(guide_name("irradiance, guided", kBins, "maps shared"), joining, maps, shared_map,
      shared_map.size());
  add(guide_name("irradiance, guided at two vertices", kBins, "maps shared"), joining, maps,
      shared_map, shared_map.size(), 1, &shared);
  add(guide_name("irradiance, guided at every vertex", kBins, "maps shared"), joining, maps,
      shared_map, shared_map.size(), GuideField::kAllHits, &shared);
  add(guide_name("irradiance, guided", kBins, "traced maps shared"), joining,
      GuideMaps::traced(renderer.bvh(), renderer.lights(), shared.view(), kBins, kTracedPaths),
      shared_map, shared_map.size());
  return rows;
}

}  // namespace lte::experiments
