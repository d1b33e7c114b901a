// Luminaires that bring no light to what is asked about: the sky outside a closed room, the lamps
// of the flat next door. Light is linear, so a network that is not told of them answers the same
// question, and a thousandth of a bright sky that it would let through a wall is no longer there.
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

namespace lte::infer {

/// Places on surfaces, of others' memory.
struct SurfacePlaces {
  std::span<const Vec3> position;
  std::span<const Vec3> normal;  ///< unit, towards the side that is asked about
};

/// What a network is asked about: what cameras see, or places.
using Asked = std::variant<std::vector<scene::Camera>, SurfacePlaces>;

/// The light groups of which nothing arrives at what is asked about, by some 28,000 paths of five
/// hits in all and four from each place at least, with a light sample at every hit that draws all
/// groups alike. What one path in 30,000 would find may be missed: it then counts as none. Of
/// cameras these are the paths from some 400 places that they see, 64 from each.
/// @return  in order; empty without places, and where no surface is seen
std::vector<int> unreached_groups(const pathtrace::Bvh& bvh, const Asked& asked, uint64_t seed);

/// The names of light groups, for a report.
std::vector<std::string> names_of(const scene::Scene& scene, std::span<const int> groups);

/// A line to people: that the network is not told of light that does not reach what is asked about,
/// and which.
std::string left_out_note(const scene::Scene& scene, std::span<const int> groups,
                          const Asked& asked);

/// Keeps the points whose light group (kNone for those of surfaces) `keeps` is for.
void keep_points(const std::function<bool(int group)>& keeps, scene::SurfaceSamples* samples);

/// Takes the light of groups out of estimates of `all_groups`: zeros stand for it.
void leave_out(std::span<const int> groups, int64_t all_groups, pathtrace::LightEstimates* light);

}  // namespace lte::infer
