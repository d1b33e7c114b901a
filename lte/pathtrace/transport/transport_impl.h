// Internal: how BasicTransport (transport.h) works. Files that bring an observer of their own
// include this; all others take Transport, which is compiled once.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/interruption.h"
#include "lte/pathtrace/balance_heuristic.h"
#include "lte/pathtrace/blocks/path_kernels.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/lights/light_lanes.h"
#include "lte/pathtrace/materials/lambert.h"
#include "lte/pathtrace/transport/transport.h"
#include "lte/scene/shading_normal.h"
#include "lte/scene/surface.h"
#include "lte/scene/texel_densities.h"

namespace lte::pathtrace {

/// Light samples stand off their surface already; this only covers rounding of the distance.
inline constexpr float kShadowLength = 1 - 0x1p-20f;

template <typename Observer, DirectionSampler Directions>
BasicTransport<Observer, Directions>::BasicTransport(const Bvh& bvh, const Lights& lights,
                                                     int max_depth, int roulette_depth,
                                                     LightSink& sink, Observer observer,
                                                     const Directions& directions)
    : handles_(bvh.handles()),
      scene_(bvh.scene()),
      lights_(lights),
      max_depth_(max_depth),
      roulette_depth_(roulette_depth),
      sink_(sink),
      observer_(std::move(observer)),
      sampled_(directions) {}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::trace_from_surface(const Vec3& position,
                                                              const Vec3& normal,
                                                              PathSampler& sampler) {
  for (int lane = 0; lane < sampler.paths(); ++lane) {
    paths_.origin.put(lane, position);
    paths_.normal.put(lane, normal);
  }
  trace_from_surfaces(sampler);
}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::trace_from_surfaces(PathSampler& sampler) {
  start_at_surfaces(sampler);
  sample_lights(0, sampler);
  scatter(0, sampler);
  follow(sampler);
}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::trace_indirect(PathSampler& sampler,
                                                          std::span<const Vec3> geometric) {
  start_at_surfaces(sampler);
  geometric_.assign(geometric.begin(), geometric.end());
  for (int lane = 0; lane < static_cast<int>(geometric.size()); ++lane) geometric_of_[lane] = lane;
  scatter(0, sampler);
  follow(sampler);
}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::start_at_surfaces(const PathSampler& sampler) {
  paths_.size = sampler.paths();
  metal_.clear();
  geometric_.clear();
  sampled_.clear();
  for (int lane = 0; lane < paths_.size; ++lane) {
    paths_.throughput.put(lane, {1, 1, 1});
    paths_.path[lane] = lane;
    metal_of_[lane] = scene::kNone;
    sampled_.put(lane, 0, lane, paths_.origin.at(lane), paths_.normal.at(lane));
  }
}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::trace_from_camera(PathSampler& sampler) {
  paths_.size = sampler.paths();
  for (int lane = 0; lane < paths_.size; ++lane) {
    paths_.normal.put(lane, {});
    paths_.throughput.put(lane, {1, 1, 1});
    paths_.pdf[lane] = 0;
    paths_.path[lane] = lane;
  }
  follow(sampler);
}

/// Follows the paths of the block from hit to hit; the first hit has depth 1.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::follow(PathSampler& sampler) {
  Interruption::check();
  for (int depth = 1; depth <= max_depth_; ++depth) {
    end_unwanted();
    if (paths_.size == 0) return;
    // The last ray can only find an area light or the environment.
    const bool last = depth == max_depth_;
    if (last && !lights_.can_be_hit()) return;
    observer_.nearest(depth, paths_);
    rays_traced_ += paths_.size;
    intersect(handles_.top, handles_.packet_width, paths_.origin, paths_.direction, paths_.size,
              &hits_);
    if constexpr (requires { observer_.met(depth, paths_, hits_); })
      observer_.met(depth, paths_, hits_);
    if (last) return collect_emission(depth);
    shade(depth);
    sample_lights(depth, sampler);
    if (depth >= roulette_depth_) russian_roulette(depth, sampler);
    scatter(depth, sampler);
  }
}

/// Ends the paths that the observer does not want any more, and closes up their lanes.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::end_unwanted() {
  if constexpr (requires { observer_.wanted(0); }) {
    int kept = 0;
    for (int lane = 0; lane < paths_.size; ++lane) {
      if (!observer_.wanted(paths_.path[lane])) continue;
      move_lane(lane, kept);
      paths_.direction.put(kept, paths_.direction.at(lane));
      paths_.pdf[kept++] = paths_.pdf[lane];
    }
    paths_.size = kept;
  }
}

/// Asks the observer for the light on a diffuse hit, and adds it if it is known.
/// @param throughput  albedo of the hit included
template <typename Observer, DirectionSampler Directions>
bool BasicTransport<Observer, Directions>::end_where_known(
    [[maybe_unused]] int lane, [[maybe_unused]] int depth,
    [[maybe_unused]] const SurfacePoint& point, [[maybe_unused]] const Vec3& side,
    [[maybe_unused]] const Rgb& throughput) {
  if constexpr (requires(Rgb * e) { observer_.known_irradiance(1, 1.0f, side, side, e); }) {
    Rgb irradiance;
    if (!observer_.known_irradiance(depth, hits_.t[lane], point.position, side, &irradiance))
      return false;
    contributions_[contribution_count_++] = {throughput * irradiance * (1 / kPi), scene::kNone,
                                             paths_.path[lane]};
    return true;
  }
  return false;
}

/// Metres that a ray stands for where it meets a surface: textures are filtered over them.
template <typename Observer, DirectionSampler Directions>
float BasicTransport<Observer, Directions>::footprint([[maybe_unused]] float distance) const {
  if constexpr (requires { observer_.footprint(distance); }) return observer_.footprint(distance);
  return 0;
}

/// Adds emission where rays have met something, and moves the paths on to their hits: origin, side,
/// and throughput with the albedo of diffuse vertices. Closes up the lanes of paths that end.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::shade(int depth) {
  int kept = 0;
  metal_.clear();
  geometric_.clear();
  sampled_.clear();
  for (int lane = 0; lane < paths_.size; ++lane) {
    const int instance = hits_.instance[lane];
    if (instance == scene::kNone) {
      if (lights_.has_environment()) add_environment(lane);
      continue;
    }
    const InstanceRecord& record = handles_.instances[static_cast<size_t>(instance)];
    const uint32_t triangle = hits_.triangle[lane];
    const float u = hits_.u[lane], v = hits_.v[lane];
    Rgb albedo = record.albedo, emission = record.emission;
    if (!record.uniform) {
      if constexpr (requires { observer_.texels; }) {
        scene::evaluate_appearance(scene_, instance, triangle, u, v, footprint(hits_.t[lane]),
                                   observer_.texels, &albedo, &emission);
      } else {
        scene::evaluate_appearance(scene_, instance, triangle, u, v, footprint(hits_.t[lane]),
                                   &albedo, &emission);
      }
    }
    const SurfacePoint point = surface_point(record, triangle, u, v, hits_.normal.at(lane));
    const float cos_front = -dot(point.normal, paths_.direction.at(lane));
    if (record.emissive) add_emission(lane, emission, cos_front);
    const Vec3 side = cos_front >= 0 ? point.normal : -point.normal;
    const scene::Gloss gloss = record.uniform || !record.glossy
                                   ? record.gloss
                                   : scene::evaluate_gloss(scene_, instance, triangle, u, v, 0);
    Vec3 normal = side;
    geometric_of_[kept] = scene::kNone;
    if (record.normal_mapped) {
      normal = scene::shading_normal(scene_, instance, triangle, u, v, footprint(hits_.t[lane]),
                                     point.normal);
      if (cos_front < 0) normal = -normal;
      geometric_of_[kept] = static_cast<int32_t>(geometric_.size());
      geometric_.push_back(side);
    }
    Rgb throughput = paths_.throughput.at(lane);
    if (gloss.metallic > 0) {
      metal_of_[kept] = static_cast<int32_t>(metal_.size());
      metal_.emplace_back(albedo, gloss.metallic, gloss.roughness, normal,
                          -paths_.direction.at(lane));
    } else {
      metal_of_[kept] = scene::kNone;
      throughput *= lambert_weight(albedo);
    }
    if (!(max_component(throughput) > 0)) continue;
    if (gloss.metallic <= 0 && end_where_known(lane, depth, point, side, throughput)) continue;
    if (gloss.metallic > 0 || record.normal_mapped) {
      sampled_.leave(kept);
    } else {
      sampled_.put(kept, depth, paths_.path[lane], point.position, side);
    }
    paths_.origin.put(kept, point.position + side * point.offset);
    paths_.normal.put(kept, normal);
    paths_.throughput.put(kept, throughput);
    paths_.path[kept++] = paths_.path[lane];
  }
  paths_.size = kept;
  deliver(depth);
}

/// Adds emission at the last depth, where nothing else counts.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::collect_emission(int depth) {
  for (int lane = 0; lane < paths_.size; ++lane) {
    const int instance = hits_.instance[lane];
    if (instance == scene::kNone) {
      if (lights_.has_environment()) add_environment(lane);
      continue;
    }
    const InstanceRecord& record = handles_.instances[static_cast<size_t>(instance)];
    if (!record.emissive) continue;
    Rgb albedo, emission = record.emission;
    if (!record.uniform) {
      scene::evaluate_appearance(scene_, instance, hits_.triangle[lane], hits_.u[lane],
                                 hits_.v[lane], 0, &albedo, &emission);
    }
    const Vec3 normal = frame_normal(record, hits_.normal.at(lane));
    add_emission(lane, emission, -dot(normal, paths_.direction.at(lane)));
  }
  deliver(depth);
}

/// Adds the light of a surface that a ray has hit, weighted by the balance heuristic.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::add_emission(int lane, const Rgb& emission,
                                                        float cos_front) {
  const int instance = hits_.instance[lane];
  const InstanceRecord& record = handles_.instances[static_cast<size_t>(instance)];
  if (!(cos_front > 0 || record.two_sided)) return;
  float weight = 1;
  const float pdf = paths_.pdf[lane], distance = hits_.t[lane];
  if (pdf > 0) {
    const float light_pdf =
        lights_.pdf(paths_.origin.at(lane), paths_.normal.at(lane), instance, hits_.triangle[lane],
                    distance * distance, std::fabs(cos_front));
    weight = balance_heuristic(pdf, light_pdf);
  }
  contributions_[contribution_count_++] = {paths_.throughput.at(lane) * emission * weight,
                                           record.light_group, paths_.path[lane]};
}

/// Adds what a ray that leaves the scene brings, weighted by the balance heuristic.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::add_environment(int lane) {
  const EnvironmentSampler& environment = lights_.environment();
  const EnvironmentSample seen =
      environment.evaluate(paths_.normal.at(lane), paths_.direction.at(lane));
  const float pdf = paths_.pdf[lane];
  const float weight = pdf > 0 ? balance_heuristic(pdf, lights_.environment_pdf(seen)) : 1.0f;
  contributions_[contribution_count_++] = {paths_.throughput.at(lane) * seen.radiance * weight,
                                           environment.light_group(), paths_.path[lane]};
}

/// Next-event estimation at the vertex where the paths stand.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::sample_lights(int vertex, PathSampler& sampler) {
  sampler.light(vertex, paths_.path, paths_.size, &light_numbers_);
  sample_light_lanes(lights_, paths_.origin, paths_.normal, light_numbers_, paths_.size,
                     &light_samples_);
  weigh_diffuse(paths_.normal, light_samples_.direction, light_samples_.pdf, paths_.size,
                light_weight_);
  if (!metal_.empty()) weigh_metal();
  if (sampled_.any()) sampled_.weigh(paths_, light_samples_, light_weight_);
  if (!geometric_.empty()) drop_light_from_below();
  cast_shadows(vertex + 1);
}

/// Weighs the light samples at metallic vertices anew: their reflectance has a color of its own.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::weigh_metal() {
  for (int lane = 0; lane < paths_.size; ++lane) {
    if (metal_of_[lane] == scene::kNone || light_weight_[lane] == 0) continue;
    const Scattering to_light =
        metal_[static_cast<size_t>(metal_of_[lane])].evaluate(light_samples_.direction.at(lane));
    light_weight_[lane] = 1 / balance_density(light_samples_.pdf[lane], to_light.pdf);
    light_samples_.radiance.put(lane, light_samples_.radiance.at(lane) * to_light.value);
  }
}

/// Light samples above a shading normal's horizon may lie below the surface's own.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::drop_light_from_below() {
  for (int lane = 0; lane < paths_.size; ++lane) {
    if (leaves_below(lane, light_samples_.direction.at(lane))) light_weight_[lane] = 0;
  }
}

/// Traces the light samples that bring something, and delivers those that arrive.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::cast_shadows(int depth) {
  int kept = 0;
  for (int lane = 0; lane < paths_.size; ++lane) {
    // Without a branch: half of the samples may lie behind a surface.
    const Rgb value =
        paths_.throughput.at(lane) * light_samples_.radiance.at(lane) * light_weight_[lane];
    shadows_.origin.put(kept, paths_.origin.at(lane));
    shadows_.direction.put(kept, light_samples_.direction.at(lane));
    shadows_.value.put(kept, value);
    shadows_.t_max[kept] = light_samples_.distance[lane] * kShadowLength;
    shadows_.light_group[kept] = light_samples_.light_group[lane];
    shadows_.path[kept] = paths_.path[lane];
    kept += max_component(value) > 0 ? 1 : 0;
  }
  shadows_.size = kept;
  observer_.shadow(shadows_);
  rays_traced_ += kept;
  occluded(handles_.top, handles_.packet_width, shadows_, flags_);
  for (int lane = 0; lane < kept; ++lane) {
    contributions_[contribution_count_] = {shadows_.value.at(lane), shadows_.light_group[lane],
                                           shadows_.path[lane]};
    contribution_count_ += 1 - flags_[lane];
  }
  deliver(depth);
}

/// Ends paths by Russian roulette, and closes up their lanes.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::russian_roulette(int vertex, PathSampler& sampler) {
  sampler.roulette(vertex, paths_.path, paths_.size, roulette_numbers_);
  pathtrace::russian_roulette(roulette_numbers_, paths_.size, &paths_.throughput, flags_);
  int kept = 0;
  for (int lane = 0; lane < paths_.size; ++lane) {
    move_lane(lane, kept);
    kept += flags_[lane];
  }
  paths_.size = kept;
}

/// Moves what a path has before its direction is chosen.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::move_lane(int from, int to) {
  paths_.origin.put(to, paths_.origin.at(from));
  paths_.normal.put(to, paths_.normal.at(from));
  paths_.throughput.put(to, paths_.throughput.at(from));
  paths_.path[to] = paths_.path[from];
  metal_of_[to] = metal_of_[from];
  geometric_of_[to] = geometric_of_[from];
  sampled_.move(from, to);
}

/// Draws the next directions.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::scatter(int vertex, PathSampler& sampler) {
  sampler.direction(vertex, paths_.path, paths_.size, &direction_numbers_);
  cosine_directions(direction_numbers_.x, direction_numbers_.y, paths_.size, paths_.normal,
                    &paths_.direction, paths_.pdf);
  if (sampled_.any() || !metal_.empty() || !geometric_.empty()) scatter_one_by_one();
}

/// Draws the directions at metallic vertices and at those of another sampler anew, and closes up
/// the lanes of paths that end there or would go on below the surface.
template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::scatter_one_by_one() {
  int kept = 0;
  for (int lane = 0; lane < paths_.size; ++lane) {
    Vec3 direction = paths_.direction.at(lane);
    Rgb throughput = paths_.throughput.at(lane);
    float pdf = paths_.pdf[lane];
    const Vec2 u{to_unit(direction_numbers_.x[lane]), to_unit(direction_numbers_.y[lane])};
    if (sampled_.has(lane)) {
      if (!sampled_.scatter(lane, paths_.normal.at(lane), u, &direction, &throughput, &pdf))
        continue;
    } else if (!metal_.empty() && metal_of_[lane] != scene::kNone) {
      const ScatteringSample next = metal_[static_cast<size_t>(metal_of_[lane])].sample(u);
      direction = next.direction;
      pdf = next.pdf;
      throughput *= next.weight;
      if (!(pdf > 0 && max_component(throughput) > 0)) continue;
    }
    if (!geometric_.empty() && leaves_below(lane, direction)) continue;
    move_lane(lane, kept);
    paths_.throughput.put(kept, throughput);
    paths_.direction.put(kept, direction);
    paths_.pdf[kept++] = pdf;
  }
  paths_.size = kept;
}

template <typename Observer, DirectionSampler Directions>
void BasicTransport<Observer, Directions>::deliver(int depth) {
  if (contribution_count_ > 0)
    sink_.add(depth, {contributions_, static_cast<size_t>(contribution_count_)});
  contribution_count_ = 0;
}

}  // namespace lte::pathtrace
