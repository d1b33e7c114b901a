#include "lte/pathtrace/reach/orientation.h"

#include "lte/base/parallel_each.h"
#include "lte/base/random.h"
#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/reach/reach_search.h"

namespace lte::pathtrace {
namespace {

constexpr int64_t kGrain = 256;
/// Rays by which a side is looked around, in a grid over the unit square.
constexpr int kColumns = 4, kRows = 2;
/// A side of which more rays than this meet a surface than of the other is more enclosed.
constexpr int kHitTolerance = 2;

/// How many rays from one side of a point meet a surface that is not of a light group.
int enclosure(const Bvh& bvh, const Vec3& position, const Vec3& side, float half_extent, Rng* rng,
              int but_of = scene::kNone) {
  const Vec3 origin = offset_origin(position, side, half_extent);
  int met = 0;
  for (int ray = 0; ray < kColumns * kRows; ++ray) {
    const int column = ray % kColumns, row = ray / kColumns;
    const Vec2 u{(static_cast<float>(column) + rng->uniform()) / kColumns,
                 (static_cast<float>(row) + rng->uniform()) / kRows};
    float density = 0;
    const Hit hit = bvh.intersect({origin, cosine_direction(side, u, &density)});
    if (!hit.valid()) continue;
    const int group = bvh.scene().instances[static_cast<size_t>(hit.instance)].light_group;
    if (but_of == scene::kNone || group != but_of) ++met;
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
  parallel_each(lit.size(), kGrain, [&](size_t i) {
    if (max_component(samples->emission[i]) > 0) return;
    Vec3& normal = samples->normal[i];
    if (lit[i] == kBackLit) normal = -normal;
    if (lit[i] != (kFrontLit | kBackLit)) return;
    normal = regardless_of_winding(normal);
    Rng rng(seed, i);
    const bool chance = rng.uniform() < 0.5f;
    const Vec3& position = samples->position[i];
    const int more = enclosure(bvh, position, normal, half_extent, &rng) -
                     enclosure(bvh, position, -normal, half_extent, &rng);
    if (more < -kHitTolerance || (more <= kHitTolerance && chance)) normal = -normal;
  });
}

std::vector<size_t> lit_from_outside(const Bvh& bvh, std::span<const uint8_t> lit, uint64_t seed,
                                     const scene::SurfaceSamples& samples) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  std::vector<uint8_t> outside(lit.size());
  parallel_each(lit.size(), kGrain, [&](size_t i) {
    if (lit[i] != kFrontLit && lit[i] != kBackLit) return;
    const Vec3 side = lit[i] == kFrontLit ? samples.normal[i] : -samples.normal[i];
    Rng rng(seed, i);
    const int here = enclosure(bvh, samples.position[i], side, half_extent, &rng);
    if (here + kHitTolerance >= kColumns * kRows) return;
    outside[i] =
        enclosure(bvh, samples.position[i], -side, half_extent, &rng) > here + kHitTolerance ? 1
                                                                                             : 0;
  });
  std::vector<size_t> numbers;
  for (size_t i = 0; i < outside.size(); ++i)
    if (outside[i] != 0) numbers.push_back(i);
  return numbers;
}

std::vector<uint8_t> shines_at_nothing(const Bvh& bvh, const scene::SurfaceSamples& samples,
                                       int64_t count, uint64_t seed) {
  const scene::Scene& scene = bvh.scene();
  std::vector<uint8_t> two_sided(scene.light_groups.size()), shines = two_sided;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (material.emissive() && material.double_sided)
      two_sided[static_cast<size_t>(instance.light_group)] = 1;
  }
  const auto group_of = [&](size_t i) { return static_cast<size_t>(samples.light_group[i]); };
  const auto counts = [&](size_t i) {
    return samples.light_group[i] != scene::kNone && two_sided[group_of(i)] != 0;
  };
  std::vector<uint8_t> nothing(static_cast<size_t>(count));
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  parallel_each(nothing.size(), kGrain, [&](size_t i) {
    if (!counts(i)) return;
    Rng rng(seed, i);
    nothing[i] = enclosure(bvh, samples.position[i], samples.normal[i], half_extent, &rng,
                           samples.light_group[i]) == 0;
  });
  for (size_t i = 0; i < nothing.size(); ++i)
    if (counts(i) && nothing[i] == 0) shines[group_of(i)] = 1;
  for (size_t i = 0; i < nothing.size(); ++i)
    if (nothing[i] != 0 && shines[group_of(i)] == 0) nothing[i] = 0;
  return nothing;
}

}  // namespace lte::pathtrace
