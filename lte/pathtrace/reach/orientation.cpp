#include "lte/pathtrace/reach/orientation.h"

#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/reach/reach_search.h"

namespace lte::pathtrace {
namespace {

constexpr int64_t kGrain = 256;
/// Rays by which a side is looked around, in a grid over the unit square.
constexpr int kColumns = 4, kRows = 2;
/// A side of which more rays than this meet a surface than of the other is more enclosed.
constexpr int kAlike = 2;

/// How many rays from one side of a point meet a surface.
int enclosure(const Bvh& bvh, const Vec3& position, const Vec3& side, float half_extent, Rng* rng) {
  const Vec3 origin = offset_origin(position, side, half_extent);
  int met = 0;
  for (int ray = 0; ray < kColumns * kRows; ++ray) {
    const Vec2 u{(static_cast<float>(ray % kColumns) + rng->uniform()) / kColumns,
                 (static_cast<float>(ray / kColumns) + rng->uniform()) / kRows};
    float density = 0;
    met += bvh.intersect({origin, cosine_direction(side, u, &density)}).valid() ? 1 : 0;
  }
  return met;
}

/// The same of a normal and of its opposite, whichever the file has.
Vec3 regardless_of_winding(const Vec3& normal) {
  return dot(normal, {0.36f, 0.8f, 0.48f}) < 0 ? -normal : normal;
}

}  // namespace

void turn_to_light(const Bvh& bvh, std::span<const uint8_t> lit, uint64_t seed,
                   scene::SurfaceSamples* samples) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  parallel_for(static_cast<int64_t>(lit.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      if (max_component(samples->emission[i]) > 0) continue;
      Vec3& normal = samples->normal[i];
      if (lit[i] == kBackLit) normal = -normal;
      if (lit[i] != (kFrontLit | kBackLit)) continue;
      normal = regardless_of_winding(normal);
      Rng rng(seed, i);
      const bool chance = rng.uniform() < 0.5f;
      const Vec3& position = samples->position[i];
      const int more = enclosure(bvh, position, normal, half_extent, &rng) -
                       enclosure(bvh, position, -normal, half_extent, &rng);
      if (more < -kAlike || (more <= kAlike && chance)) normal = -normal;
    }
  });
}

}  // namespace lte::pathtrace
