#include "experiments/guiding/guided_pixels.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/guiding/guide_maps.h"
#include "experiments/guiding/guiding_row.h"
#include "experiments/guiding/sights.h"
#include "lte/base/timer.h"

namespace lte::experiments {

using namespace infer;

namespace {

/// Points that the places of guides at every vertex come of.
constexpr int64_t kPointsAllOver = 20'000;

/// Sums over pixels of one way to draw.
struct Way {
  Statistics indirect{}, whole{};
  double seconds = 0;  ///< of paths

  void add(const Statistics& of_indirect, const Statistics& of_whole) {
    indirect = indirect + of_indirect;
    whole = whole + of_whole;
  }
  /// Variances of the mean of some paths, over the squared mean light of a pixel.
  GuidingRow row(const std::string& name, int64_t pixels, int64_t paths_drawn,
                 GuidingCost cost) const {
    GuidingRow out{name, paths_drawn, seconds, {}};
    const auto n = static_cast<double>(pixels);
    cost.path = paths_drawn > 0 ? seconds / static_cast<double>(paths_drawn) : 0;
    const auto relative = [n](const Statistics& sum) {
      return n > 0 && sum.mean > 0 ? (sum.variance / n) / ((sum.mean / n) * (sum.mean / n)) : 0;
    };
    for (const int paths : {2, 8, 32}) {
      add_variance("", paths, relative(indirect) / paths, cost.of(paths, false), &out);
      add_variance("whole_", paths, relative(whole) / paths, cost.of(paths, true), &out);
    }
    out.figures["mean"] = n > 0 ? indirect.mean / n : 0;
    out.figures["whole_mean"] = n > 0 ? whole.mean / n : 0;
    add_cost(cost, &out);
    return out;
  }
};

/// Which map serves which pixel.
struct Sharing {
  std::vector<size_t> place_of;  ///< [sights]
  double pixels = 0;             ///< that the places serve
  double seconds = 0;            ///< of the processor, to find them
};

/// Joins all pixels of a picture, of which the sights are some, to places.
Sharing by_neighbours(const std::vector<Sight>& picture, const std::vector<Sight>& sights,
                      JoinedPlaces* places) {
  const auto join = [&](const Sight& s) {
    return places->join(s.position, s.normal, s.reflector.color);
  };
  Sharing out;
  const double start = processor_seconds();
  for (const Sight& s : picture) join(s);
  out.seconds = processor_seconds() - start;
  for (const Sight& s : sights) out.place_of.push_back(join(s));
  out.pixels = static_cast<double>(picture.size());
  return out;
}

/// The ways to draw, over the same pixels.
class Ways {
 public:
  Ways(const Renderer& renderer, std::vector<Sight> sights, int64_t paths)
      : paths_(paths), renderer_(renderer), sights_(std::move(sights)) {
    const double start = processor_seconds();
    for (size_t i = 0; i < sights_.size(); ++i) {
      Rng rng(11, i);
      direct_.push_back(
          light_samples(renderer.bvh(), renderer.lights(), sights_[i], material(i), paths_, &rng));
    }
    light_seconds_ = (processor_seconds() - start) /
                     static_cast<double>(paths_ * std::max(pixels(), int64_t{1}));
  }

  const std::vector<Sight>& sights() const { return sights_; }

  void add_by_material() {
    IncidentSampler sampler(renderer_.bvh(), renderer_.lights());
    Way alone, with_lights;
    for (size_t i = 0; i < sights_.size(); ++i) {
      const Sight& s = sights_[i];
      Rng rng(7, i);
      const double start = processor_seconds();
      const IncidentSamples& drawn =
          s.reflector.gloss.metallic > 0
              ? sampler.draw(s.position, s.normal, s.reflector, paths_, rng)
              : sampler.draw(s.position, s.normal, paths_, rng);
      alone.seconds += processor_seconds() - start;
      const PathStatistics plain = statistics_of(drawn, material(i));
      alone.add(plain.indirect, plain.whole);
      with_lights.add(plain.indirect, plain.indirect + direct_[i]);
    }
    with_lights.seconds = alone.seconds;
    rows_.push_back(alone.row("paths by the material", pixels(), pixels() * paths_, {}));
    GuidingCost cost;
    cost.light = light_seconds_;
    rows_.push_back(with_lights.row("paths by the material, lamps by light samples", pixels(),
                                    pixels() * paths_, cost));
  }

  /// @param hits    at which paths are guided on; 0: only their first directions are
  /// @param places  of the maps, for these hits
  void add_guided(const std::string& name, const Sharing& sharing, const GuideMaps& maps,
                  int hits = 0, const JoinedPlaces* places = nullptr) {
    const SharedGuides guides(maps);
    std::optional<GuideField> field;
    if (hits > 0) field.emplace(guides.field(*places, hits));
    IncidentSampler sampler(renderer_.bvh(), renderer_.lights(), field ? &*field : nullptr);
    Way way;
    double preparing = 0;
    for (size_t i = 0; i < sights_.size(); ++i) {
      const Sight& s = sights_[i];
      Rng rng(7, i);
      double start = processor_seconds();
      const Guide guide = guides.guide(sharing.place_of[i], s.normal, s.reflector);
      preparing += processor_seconds() - start;
      start = processor_seconds();
      const IncidentSamples& drawn = sampler.draw(s.position, s.normal, guide, paths_, rng);
      way.seconds += processor_seconds() - start;
      const Statistics guided = statistics_of(drawn, guide).indirect;
      way.add(guided, guided + direct_[i]);
    }
    GuidingCost cost;
    cost.prediction = maps.seconds() / sharing.pixels;
    cost.tables = (sharing.seconds + guides.seconds()) / sharing.pixels +
                  preparing / static_cast<double>(sights_.size());
    cost.light = light_seconds_;
    cost.maps = static_cast<int64_t>(maps.size());
    rows_.push_back(way.row(name, pixels(), pixels() * paths_, cost));
  }

  std::vector<GuidingRow> rows() && { return std::move(rows_); }

 private:
  int64_t pixels() const { return static_cast<int64_t>(sights_.size()); }
  /// What a pixel reflects.
  Guide material(size_t i) const {
    const Sight& s = sights_[i];
    return {{even_, 2, s.normal}, s.normal, s.reflector};
  }

  const int64_t paths_;  ///< of each sight and way
  const Renderer& renderer_;
  std::vector<Sight> sights_;
  std::vector<Rgb> even_ = std::vector<Rgb>(4);
  std::vector<Statistics> direct_;  ///< [sights]
  double light_seconds_ = 0;        ///< a light sample
  std::vector<GuidingRow> rows_;
};

}  // namespace

std::vector<GuidingRow> guided_pixels(const Renderer& renderer, const scene::Camera& camera,
                                      const GuidingOptions& options) {
  Ways ways(renderer, look(renderer.bvh(), camera, options.columns, options.rows), options.paths);
  ways.add_by_material();
  const runtime::SceneEmbedding& embedding = renderer.embedding();
  PlaceList list;
  Sharing own;
  for (const Sight& s : ways.sights()) {
    own.place_of.push_back(own.place_of.size());
    list.push_back(s.position, s.normal, s.reflector.color);
  }
  own.pixels = static_cast<double>(own.place_of.size());
  for (const int bins : {32, 16, 8})
    ways.add_guided(guide_name("guided", bins, "a map a pixel"), own,
                    GuideMaps::predicted(embedding, list.view(), bins));

  const std::vector<Sight> picture = look(renderer.bvh(), camera, options.width, options.height);
  JoinedPlaces seen(options.radius_m);
  const Sharing shared = by_neighbours(picture, ways.sights(), &seen);
  for (const int bins : {32, 16, 8})
    ways.add_guided(guide_name("guided", bins, "maps shared"), shared,
                    GuideMaps::predicted(embedding, seen.view(), bins));
  constexpr int kBins = 16;
  ways.add_guided(
      guide_name("guided", kBins, "traced maps shared"), shared,
      GuideMaps::traced(renderer.bvh(), renderer.lights(), seen.view(), kBins, kTracedPaths));

  // Paths go on to what the picture does not see.
  JoinedPlaces everywhere(options.radius_m);
  const double start = processor_seconds();
  const scene::SurfaceSamples points = points_all_over(renderer.bvh().scene(), kPointsAllOver);
  for (size_t i = 0; i < points.position.size(); ++i)
    everywhere.join(points.position[i], points.normal[i], points.albedo[i]);
  const double joining = processor_seconds() - start;
  Sharing all = by_neighbours(picture, ways.sights(), &everywhere);
  all.seconds += joining;
  const GuideMaps predicted = GuideMaps::predicted(embedding, everywhere.view(), kBins);
  const GuideMaps traced =
      GuideMaps::traced(renderer.bvh(), renderer.lights(), everywhere.view(), kBins, kTracedPaths);
  for (const auto& [hits, way] : {std::pair(1, "guided at two vertices"),
                                  std::pair(GuideField::kAllHits, "guided at every vertex")}) {
    ways.add_guided(guide_name(way, kBins, "maps shared"), all, predicted, hits, &everywhere);
    ways.add_guided(guide_name(way, kBins, "traced maps shared"), all, traced, hits, &everywhere);
  }
  return std::move(ways).rows();
}

}  // namespace lte::experiments
