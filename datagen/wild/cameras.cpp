#include "datagen/wild/cameras.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/scene/luminaire_power.h"

namespace lte::datagen::wild {
namespace {

constexpr int kCandidates = 20, kDirections = 16;
constexpr int kWidth = 16, kHeight = 12, kPaths = 8, kDepth = 5;
constexpr int64_t kPoints = 256;
constexpr float kLitShare = 0.5f;  // of a camera's pixels, at least

struct Place {
  Vec3 eye, target;
  float score = 0;
};

/// Looks around from a point: the best direction is that of the longest free ways to a surface.
Place look_around(const pathtrace::Bvh& bvh, const Vec3& eye, float size) {
  std::array<float, kDirections> free{};
  float nearest = INFINITY, sum = 0;
  for (int i = 0; i < kDirections; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / kDirections;
    const pathtrace::Hit hit = bvh.intersect({eye, {std::cos(a), -0.1f, std::sin(a)}});
    free[static_cast<size_t>(i)] = hit.valid() ? std::min(hit.t, 2 * size) : 0.1f * size;
    nearest = std::min(nearest, hit.t);
    sum += free[static_cast<size_t>(i)];
  }
  Place best;
  for (int i = 0; i < kDirections; ++i) {
    float ahead = 0, closest = INFINITY;
    for (int k = -2; k <= 2; ++k) {
      const float way = free[static_cast<size_t>((i + k + kDirections) % kDirections)];
      ahead += way;
      closest = std::min(closest, way);
    }
    const float score = ahead + 0.2f * sum + 4 * std::min(nearest, 0.15f * size) +
                        5 * std::min(closest, 0.4f * size);
    if (score <= best.score) continue;
    const float a = 2 * kPi * static_cast<float>(i) / kDirections;
    best = {eye, eye + Vec3{std::cos(a), -0.18f, std::sin(a)}, score};
  }
  return nearest < 0.03f * size ? Place{} : best;
}

/// The share of a camera's pixels that show a surface which light reaches; negative where values
/// are not finite.
float lit_share(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                const scene::Camera& camera, uint64_t seed) {
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, kWidth, kHeight);
  std::vector<Vec3> position, normal;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    if (!hits.mask[i]) continue;
    position.push_back(hits.position[i]);
    normal.push_back(hits.normal[i]);
  }
  if (position.empty()) return 0;
  pathtrace::IrradianceOptions options;
  options.rays = kPaths;
  options.max_depth = kDepth;
  options.seed = seed;
  options.variance = options.by_group = false;
  const pathtrace::Irradiance found =
      pathtrace::estimate_irradiance(bvh, lights, position, normal, options);
  int lit = 0;
  for (int64_t i = 0; i < found.points; ++i) {
    const Rgb total = found.total(i);
    if (!is_finite(total)) return -1;
    if (max_component(total) > 0) ++lit;
  }
  return static_cast<float>(lit) / static_cast<float>(kWidth * kHeight);
}

}  // namespace

std::vector<scene::Camera> place_cameras(const Plan& plan, const Affine& to_world,
                                         const pathtrace::Bvh& bvh, Dice* dice) {
  std::vector<size_t> order(plan.cells.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return area_of(plan.cells[a].outline) > area_of(plan.cells[b].outline);
  });
  std::vector<scene::Camera> cameras;
  const float size = plan.unit * length(to_world.vector({1, 0, 0}));
  for (const size_t index : order) {
    const Cell& cell = plan.cells[index];
    const Vec2 centre = centre_of(cell.outline);
    Place best;
    for (int i = 0; i < kCandidates; ++i) {
      const Vec2 corner = cell.outline[dice->rng.below(cell.outline.size())];
      const Vec2 p = centre + (corner - centre) * (0.9f * std::sqrt(dice->draw(0, 1)));
      const float high = dice->draw(0.35f, 0.65f) * (cell.ceiling.eaves - cell.floor);
      const Place place = look_around(bvh, to_world.point(in_space(p, cell.floor + high)), size);
      if (place.score > best.score) best = place;
    }
    if (best.score > 0)
      cameras.push_back(
          {concat("cell ", index), best.eye, best.target, {0, 1, 0}, dice->draw(55, 85)});
  }
  return cameras;
}

std::string check_scene(const pathtrace::Bvh& bvh, uint64_t seed, scene::Scene* scene) {
  for (const scene::Mesh& mesh : scene->meshes)
    if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite))
      return concat("mesh ", mesh.name, " is not finite");
  if (scene->light_groups.empty()) return "no light";
  for (const Rgb& power : scene::luminaire_powers(*scene))
    if (!is_finite(power) || max_component(power) < 0) return "a light without power";
  const pathtrace::Lights lights(*scene);
  std::vector<scene::Camera> lit;
  for (const scene::Camera& camera : scene->cameras) {
    const float share = lit_share(bvh, lights, camera, seed);
    if (share < 0) return "light that is not finite";
    if (share > kLitShare) lit.push_back(camera);
  }
  if (lit.empty()) return "no camera that sees light";
  scene->cameras = std::move(lit);
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  pathtrace::PruneCounts counts;
  const scene::SurfaceSamples points = pathtrace::sample_reached_surface(
      bvh, kPoints, sampler, pathtrace::Purpose::Queries, {kDepth, seed}, &counts);
  if (points.size() < kPoints) return "light reaches too little of the surface";
  return {};
}

}  // namespace lte::datagen::wild
