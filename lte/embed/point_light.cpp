#include "lte/embed/point_light.h"

#include <algorithm>
#include <utility>

#include "lte/embed/culled_lights.h"
#include "lte/radiosity/point_radiosity.h"

namespace lte::embed {
namespace {

/// Rays from each side of a point for direct light that is traced for a solution.
constexpr int kDirectRays = 16;

/// 1 for the light groups that points describe badly.
std::vector<uint8_t> needs_tracing(const scene::Scene& scene, std::span<const int> culled) {
  std::vector<uint8_t> groups(scene.light_groups.size());
  for (const scene::PunctualLight& light : scene.lights)
    if (light.kind != scene::LightKind::Directional)
      groups[static_cast<size_t>(light.light_group)] = 1;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (material.emissive() && material.emission_texture.texture != scene::kNone)
      groups[static_cast<size_t>(instance.light_group)] = 1;
  }
  for (const int group : culled) groups[static_cast<size_t>(group)] = 0;
  return groups;
}

/// Sums [G, points] values over the groups of the mask, at some points.
std::vector<Rgb> sum_over(const std::vector<uint8_t>& groups, std::span<const size_t> rows,
                          size_t points, const std::vector<Rgb>& values) {
  std::vector<Rgb> sum(rows.size());
  for (size_t g = 0; g < groups.size(); ++g) {
    for (size_t k = 0; groups[g] != 0 && k < rows.size(); ++k)
      sum[k] += values[g * points + rows[k]];
  }
  return sum;
}

}  // namespace

data::GroupedLight light_to_read(const pathtrace::LightEstimates& light,
                                 const runtime::LightRequest& input) {
  if (input.depth == 0) return {};
  return {.direct = light.direct,
          .indirect = light.indirect,
          .direct_back = light.direct_back,
          .indirect_back = light.indirect_back,
          .error = light.error,
          .error_back = light.error_back};
}

LitSamples add_light_estimates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               scene::SurfaceSamples surface, const runtime::LightRequest& input,
                               uint64_t seed, std::span<const int> culled) {
  LitSamples out{std::move(surface), {}};
  if (input.depth == 0) return out;
  const scene::SurfaceSamples& s = out.surface;
  if (lights.empty()) {
    const std::vector<Rgb> dark(s.position.size());
    out.light.direct = out.light.indirect = dark;
    out.light.direct_back = out.light.indirect_back = dark;
    out.light.error.resize(2 * dark.size());
    return out;
  }
  pathtrace::LightEstimates light =
      pathtrace::estimate_light(bvh, lights, s.position, s.normal, s.emission,
                                {.paths = input.paths, .max_depth = input.depth, .seed = seed});
  darken(culled, lights.groups(), &light);
  out.light = data::sum_groups(light_to_read(light, input), lights.groups());
  return out;
}

void solve_traced_lights(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                         const runtime::ModelConfig& model, uint64_t seed,
                         std::span<const int> culled, LitSamples* lit) {
  const std::vector<uint8_t> traced = needs_tracing(bvh.scene(), culled);
  if (!model.solves_light() || std::ranges::count(traced, 1) == 0) return;
  const scene::SurfaceSamples& s = lit->surface;
  const pathtrace::LightEstimates light =
      pathtrace::estimate_light(bvh, lights, s.position, s.normal, s.emission,
                                {.paths = kDirectRays, .max_depth = 1, .seed = seed});
  scene::SurfaceSamples solved_on = s;
  std::vector<size_t> rows;  // lights that are no surface are in nobody's way
  for (size_t i = 0; i < s.position.size(); ++i) {
    const bool solved_here =
        s.light_group[i] == scene::kNone || traced[static_cast<size_t>(s.light_group[i])] == 0;
    if (!solved_here) solved_on.emission[i] = {};
    if (solved_here || max_component(s.albedo[i]) > 0) rows.push_back(i);
  }
  solved_on.keep(rows);
  const std::vector<Rgb> direct = sum_over(traced, rows, s.position.size(), light.direct),
                         back = sum_over(traced, rows, s.position.size(), light.direct_back);
  const radiosity::PointIrradiance solved = radiosity::solve({solved_on.position,
                                                              solved_on.normal,
                                                              solved_on.albedo,
                                                              solved_on.emission,
                                                              solved_on.area,
                                                              {},
                                                              direct,
                                                              back},
                                                             1);
  const auto spread = [&](const std::vector<Rgb>& values) {
    std::vector<Rgb> out(s.position.size());
    for (size_t k = 0; k < rows.size(); ++k) out[rows[k]] = values[k];
    return out;
  };
  lit->light.direct = spread(solved.direct);
  lit->light.indirect = spread(solved.indirect);
  lit->light.direct_back = spread(solved.direct_back);
  lit->light.indirect_back = spread(solved.indirect_back);
}

}  // namespace lte::embed
