// Path guiding by a map of radiance over the hemisphere of a point, such as a radiance decoder
// answers (the paper's supplement, section 4): directions drawn in proportion to radiance times
// what the surface reflects, by inverting the distribution over the cells of the map.
//
// A map may be made at one point and serve others near it (shared_places.h): the mean stays the
// same whatever the map says, and only the variance depends on how well it fits.
#pragma once

#include <memory>

#include "experiments/guiding/guide_table.h"
#include "experiments/guiding/incident_sampler.h"
#include "lte/base/math.h"

namespace lte::experiments {

struct GuideOptions {
  /// Share of draws that are spread evenly over the cells, so that no direction has density zero
  /// and a wrong map does no more harm than that share.
  float even_share = 0.1f;
  /// Share of draws by the material alone, combined with the others by the balance heuristic.
  float material_share = 0.5f;
};

/// Draws directions at one point, for one view of it.
class Guide {
 public:
  /// By radiance times what the surface reflects.
  /// @param map        around `normal`, or around that of a point nearby
  /// @param reflector  the surface; a metallic of 0 is Lambertian
  /// @throws lte::Error as GuideTable, or if the material share is not in [0, 1), or is 0 for a map
  ///         around another normal, whose hemisphere does not have all directions
  Guide(const DirectionMap& map, const Vec3& normal, const Reflector& reflector,
        const GuideOptions& options = {});
  /// By a table that is shared, made without the surface: cheap.
  Guide(std::shared_ptr<const GuideTable> table, const Vec3& normal, const Reflector& reflector,
        float material_share = GuideOptions{}.material_share);
  ~Guide();
  Guide(Guide&&) noexcept;

  /// A direction, f cosθ over the density with which draw() makes it, and that density.
  struct Draw {
    Vec3 direction;  ///< world, unit; the normal where `pdf` is 0
    Rgb weight;
    float pdf = 0;  ///< 0: no direction came of this draw, which counts as a sample of 0
  };
  /// @param u  of the unit square
  Draw draw(Vec2 u) const;

  /// Solid-angle density of draw(): the sum over all the ways in which it may make a direction.
  float pdf(const Vec3& direction) const;

  /// f cosθ of a direction, 1/sr.
  Rgb reflected(const Vec3& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lte::experiments
