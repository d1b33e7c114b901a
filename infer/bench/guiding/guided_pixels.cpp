#include "infer/bench/guiding/guided_pixels.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "infer/bench/guiding/guide_maps.h"
#include "infer/bench/guiding/guiding_row.h"
#include "infer/bench/guiding/sights.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

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

/// What of a map serves the pixels: the places where maps are made, and which each pixel has.
struct Sharing {
  PlaceList places;
  std::vector<size_t> place_of;  ///< [sights]
  double pixels = 0;             ///< that the places serve
  double seconds = 0;            ///< of the processor, to find them
};

Sharing each_its_own(const std::vector<Sight>& sights) {
  Sharing out;
  for (const Sight& s : sights) {
    out.place_of.push_back(out.place_of.size());
    out.places.push_back(s.position, s.normal, s.reflector.color);
  }
  out.pixels = static_cast<double>(sights.size());
  return out;
}

/// Over all pixels of a picture, of which the sights are some.
Sharing by_neighbours(const std::vector<Sight>& picture, const std::vector<Sight>& sights,
                      double radius_m) {
  Sharing out;
  const double start = processor_seconds();
  pathtrace::SharedPlaces places(static_cast<float>(radius_m), kLeastCosine);
  const auto join = [&](const Sight& s) {
    const auto place = static_cast<size_t>(places.join(s.position, s.normal));
    if (place == out.places.position.size())
      out.places.push_back(s.position, s.normal, s.reflector.color);
    return place;
  };
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
      : paths_(paths),
        renderer_(renderer),
        sampler_(renderer.bvh(), renderer.lights()),
        sights_(std::move(sights)) {
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
    Way alone, with_lights;
    for (size_t i = 0; i < sights_.size(); ++i) {
      const Sight& s = sights_[i];
      Rng rng(7, i);
      const double start = processor_seconds();
      const pathtrace::IncidentSamples& drawn =
          s.reflector.gloss.metallic > 0
              ? sampler_.draw(s.position, s.normal, s.reflector, paths_, rng)
              : sampler_.draw(s.position, s.normal, paths_, rng);
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

  void add_guided(const std::string& name, const Sharing& sharing, const GuideMaps& maps) {
    const SharedGuides guides(maps);
    Way way;
    double preparing = 0;
    for (size_t i = 0; i < sights_.size(); ++i) {
      const Sight& s = sights_[i];
      Rng rng(7, i);
      double start = processor_seconds();
      const pathtrace::Guide guide = guides.guide(sharing.place_of[i], s.normal, s.reflector);
      preparing += processor_seconds() - start;
      start = processor_seconds();
      const pathtrace::IncidentSamples& drawn =
          sampler_.draw(s.position, s.normal, guide, paths_, rng);
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
  pathtrace::Guide material(size_t i) const {
    const Sight& s = sights_[i];
    return {{even_, 2, s.normal}, s.normal, s.reflector};
  }

  const int64_t paths_;  ///< of each sight and way
  const Renderer& renderer_;
  pathtrace::IncidentSampler sampler_;
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
  const Sharing own = each_its_own(ways.sights());
  const Sharing shared = by_neighbours(look(renderer.bvh(), camera, options.width, options.height),
                                       ways.sights(), options.radius_m);
  for (const auto& [sharing, name] :
       {std::pair(&own, "a map a pixel"), std::pair(&shared, "maps shared")}) {
    for (const int bins : {32, 16, 8})
      ways.add_guided(guide_name("guided", bins, name), *sharing,
                      GuideMaps::predicted(renderer.embedding(), sharing->places.view(), bins));
  }
  constexpr int kTracedBins = 16;
  ways.add_guided(guide_name("guided", kTracedBins, "traced maps shared"), shared,
                  GuideMaps::traced(renderer.bvh(), renderer.lights(), shared.places.view(),
                                    kTracedBins, kTracedPaths));
  return std::move(ways).rows();
}

}  // namespace lte::infer
