// Final gather: indirect irradiance by one bounce of rays whose hits read an irradiance cache.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/sample_number.h"

namespace lte::gi {

struct GatherOptions {
  int rays = 16;  ///< a point: stratified, by the cosine and aimed at the cache's bright places
  /// A hit nearer than this many radii of the cache goes on by another segment, since the cache
  /// knows nothing finer than its radius: its direct light is one light sample, and its next hit
  /// reads the cache. Infinite: all do.
  float near = 0.5f;
  /// Hits of a path that may be so near, from its first on. Paths within narrow gaps, as behind
  /// furniture, are near all the way: more of them carry no light into the dark.
  int near_hits = 1;
  /// Surface hits of paths that the cache does not end: those along metal, and those that leave the
  /// surfaces it knows.
  int max_depth = 5;
  /// Points that lie side by side, by number: rays of all are aimed as those of the first.
  int together = 1;
  bool last = false;  ///< whether Gathered::last is wanted
  uint64_t seed = 0;
  /// [points] For point sets that go on over several calls. Empty: points draw by their number.
  std::span<const pathtrace::SampleNumber> numbers{};
};

struct Gathered {
  std::vector<Rgb> indirect;  ///< [points], summed over light groups, W/m²
  /// [points]: of direct light what the rays meet, by the balance heuristic against as many light
  /// samples (pathtrace::DirectOptions::hemisphere_elsewhere with a share of 1). Both sum up to it.
  std::vector<Rgb> met;
  std::vector<Rgb> last;    ///< [points]: of `indirect`, what paths found at max_depth; or empty
  int64_t rays_traced = 0;  ///< nearest and shadow rays
  int64_t lookups = 0, misses = 0;  ///< of the cache; a miss makes the path go on
};

/// Estimates indirect irradiance at points: what light brings that at least one surface has
/// reflected. Emitters and environments that rays meet at once are direct light, and apart.
/// Unbiased but for what the cache's values are wrong by, for textures, which are filtered over a
/// part of what a ray stands for, and for paths cut at max_depth. Where the cache's light has depth
/// d, the result has depth d + 1: a hit after the first reads light of one bounce less.
///
/// Point i has the number first_index + i, by which it draws random numbers: the result depends
/// neither on threads nor on how a set is cut into calls. Rays of 64 points whose numbers follow
/// each other are stratified together, so neighbors should have neighboring numbers.
/// @param geometric_normals  of the surfaces, where `normals` are shading normals: no light arrives
///                           from below them. Empty where they are the same.
/// @throws lte::Error as pathtrace::estimate_irradiance()
Gathered gather_irradiance(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                           const IrradianceCache& cache, std::span<const Vec3> positions,
                           std::span<const Vec3> normals, const GatherOptions& options,
                           int64_t first_index = 0, std::span<const Vec3> geometric_normals = {});

}  // namespace lte::gi
