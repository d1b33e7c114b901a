// Luminaires that bring no light to the receivers: the sky outside a closed room, the lamps of the
// flat next door. Light is linear, so culling them changes no answer, but for the thousandth of a
// bright sky that a network would let through a wall.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/light_estimates.h"
#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::embed {

/// Places on surfaces, of others' memory.
struct SurfacePlaces {
  std::span<const Vec3> position;
  std::span<const Vec3> normal;  ///< unit, of the side whose light is wanted
};

/// Where light is wanted: what cameras see, or places.
using Receivers = std::variant<std::vector<scene::Camera>, SurfacePlaces>;

/// The light groups of which nothing arrives at the receivers, by some 28,000 paths of five
/// hits in all and four from each place at least, with a light sample at every hit that draws all
/// groups alike. What one path in 30,000 would find may be missed: it then counts as none. Of
/// cameras these are the paths from some 400 places that they see, 64 from each.
/// @return  in order; empty without places, and where no surface is seen
std::vector<int> culled_lights(const pathtrace::Bvh& bvh, const Receivers& receivers,
                               uint64_t seed);

/// The names of light groups, for a report.
std::vector<std::string> names_of(const scene::Scene& scene, std::span<const int> groups);

/// A line for people that names the culled lights.
std::string culled_lights_note(const scene::Scene& scene, std::span<const int> groups,
                               const Receivers& receivers);

/// Keeps the points whose light group (kNone for those of surfaces) `keeps` is for.
void keep_points(const std::function<bool(int group)>& keeps, scene::SurfaceSamples* samples);

/// Sets the light of some groups to zero in estimates of `all_groups`.
void darken(std::span<const int> groups, int64_t all_groups, pathtrace::LightEstimates* light);

}  // namespace lte::embed
