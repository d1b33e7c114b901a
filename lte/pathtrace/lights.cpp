#include "lte/pathtrace/lights.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/pathtrace/embree_scene.h"

namespace lte::pathtrace {
namespace {

/// Texture taps a side of the grid that estimates the mean emission of a textured triangle.
constexpr int kTaps = 4;

/// Share of a textured triangle's weight that ignores the texture, so that a bright texel between
/// the taps is still drawn. The estimate stays unbiased whatever the weights are, as long as no
/// emitting point has weight zero.
constexpr double kTextureFloor = 0.1;

/// Heitz's low-distortion map of the unit square onto barycentrics (2019), without a branch that
/// half of all samples would mispredict.
Vec3 square_to_triangle(const Vec2& u) {
  const float x = u.x * 0.5f, y = u.y * 0.5f, offset = y - x;
  const float b1 = x - std::min(offset, 0.0f), b2 = y + std::max(offset, 0.0f);
  return {1 - b1 - b2, b1, b2};
}

double mean_textured_luminance(const scene::Scene& scene, int instance, uint32_t triangle,
                               double area) {
  const auto footprint = static_cast<float>(std::sqrt(area) / kTaps);
  double sum = 0;
  for (int y = 0; y < kTaps; ++y) {
    for (int x = 0; x < kTaps; ++x) {
      const Vec3 b = square_to_triangle({(x + 0.5f) / kTaps, (y + 0.5f) / kTaps});
      Rgb albedo, emission;
      evaluate_appearance(scene, instance, triangle, b.y, b.z, footprint, &albedo, &emission);
      sum += luminance(emission);
    }
  }
  return sum / (kTaps * kTaps);
}

/// The windowing and inverse square law of KHR_lights_punctual.
float range_window(float distance, float range) {
  if (!std::isfinite(range)) return 1;
  const float ratio = distance / range;
  return std::clamp(1 - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
}

float spot_factor(const scene::PunctualLight& light, const Vec3& direction_to_light) {
  const float cos_outer = std::cos(light.outer_cone);
  const float width = std::max(0.001f, std::cos(light.inner_cone) - cos_outer);
  const float cos_angle = -dot(light.direction, direction_to_light);
  const float factor = std::clamp((cos_angle - cos_outer) / width, 0.0f, 1.0f);
  return factor * factor;
}

/// Radiant power by luminance; a directional light's through the disc that bounds the scene.
double punctual_power(const scene::PunctualLight& light, const Bounds& bounds) {
  const double intensity = luminance(light.intensity);
  switch (light.kind) {
    case scene::LightKind::Point:
      return 4 * kPi * intensity;
    case scene::LightKind::Spot:
      return 2 * kPi * intensity * (1 - std::cos(light.outer_cone));
    case scene::LightKind::Directional: {
      const double radius = std::max(length(bounds.extent()) / 2, 1e-3f);
      return kPi * radius * radius * intensity;
    }
  }
  return 0;
}

}  // namespace

AliasTable::AliasTable(const std::vector<double>& weights) {
  double total = 0;
  for (const double weight : weights) total += weight;
  if (!(total > 0)) return;
  const size_t count = weights.size();
  threshold_.resize(count);
  probability_.resize(count);
  alias_.resize(count);
  std::vector<double> scaled(count);
  std::vector<uint32_t> small, large;
  for (uint32_t i = 0; i < count; ++i) {
    probability_[i] = static_cast<float>(weights[i] / total);
    scaled[i] = weights[i] / total * static_cast<double>(count);
    alias_[i] = i;
    (scaled[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const uint32_t low = small.back(), high = large.back();
    small.pop_back();
    threshold_[low] = static_cast<float>(scaled[low]);
    alias_[low] = high;
    scaled[high] -= 1 - scaled[low];
    if (scaled[high] < 1) {
      large.pop_back();
      small.push_back(high);
    }
  }
  // What is left is 1 up to rounding, except entries without weight, which must stay undrawable.
  for (const uint32_t i : large) threshold_[i] = 1;
  for (const uint32_t i : small) threshold_[i] = weights[i] > 0 ? 1.0f : 0.0f;
}

Lights::Lights(const scene::Scene& scene)
    : scene_(scene),
      groups_(static_cast<int>(scene.light_groups.size())),
      first_of_instance_(scene.instances.size(), -1) {
  const Bounds bounds = scene.bounds();
  origin_ = frame_origin(bounds);
  std::vector<double> weights;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    if (!scene.materials[mesh.material].emissive()) continue;
    LTE_CHECK(instance.light_group != scene::kNone, "instance ", i, " (mesh ", mesh.name,
              ") emits light but has no light group");
    groups_ = std::max(groups_, instance.light_group + 1);
    first_of_instance_[i] = static_cast<int64_t>(triangles_.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      weights.push_back(add_triangle(static_cast<int>(i), t));
    }
  }
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const scene::PunctualLight& light = scene.lights[i];
    LTE_CHECK(light.light_group != scene::kNone, "light ", i, " (", light.name,
              ") has no light group");
    groups_ = std::max(groups_, light.light_group + 1);
    weights.push_back(punctual_power(light, bounds));
  }
  table_ = AliasTable(weights);
  if (table_.empty()) {  // all black or without area: nothing to find by sampling or by hitting
    std::fill(first_of_instance_.begin(), first_of_instance_.end(), -1);
    triangles_.clear();
  }
}

double Lights::add_triangle(int instance, uint32_t triangle) {
  const scene::Instance& placed = scene_.instances[instance];
  const scene::Mesh& mesh = scene_.meshes[placed.mesh];
  const scene::Material& material = scene_.materials[mesh.material];
  const auto& corners = mesh.triangles[triangle];
  const Affine& m = placed.to_world;
  EmissiveTriangle light;
  light.instance = instance;
  light.triangle = triangle;
  light.edge1 = m.vector(mesh.positions[corners[1]] - mesh.positions[corners[0]]);
  light.edge2 = m.vector(mesh.positions[corners[2]] - mesh.positions[corners[0]]);
  Affine to_frame = m;
  for (int row = 0; row < 3; ++row) {
    to_frame.m[row][3] =
        static_cast<float>(static_cast<double>(m.m[row][3]) - static_cast<double>(origin_[row]));
  }
  light.p0 = to_frame.point(mesh.positions[corners[0]]);
  const Vec3 scaled_normal = cross(light.edge1, light.edge2);
  light.area = 0.5f * length(scaled_normal);
  light.normal = normalize(m.determinant() < 0 ? -scaled_normal : scaled_normal);
  float scale = 0, translation = 0;
  for (const auto& row : to_frame.m) {
    scale = std::max(scale, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
    translation = std::max(translation, std::fabs(row[3]));
  }
  Vec3 largest;
  for (const uint32_t corner : corners) largest = max(largest, abs(mesh.positions[corner]));
  light.offset = kSurfaceError * (max_component(largest) * scale + translation);
  light.emission = material.emission;
  light.textured = material.emission_texture.texture != scene::kNone;
  light.two_sided = material.double_sided;
  light.light_group = placed.light_group;
  triangles_.push_back(light);
  double radiance = luminance(light.emission);
  if (light.textured && light.area > 0) {
    radiance =
        kTextureFloor * radiance +
        (1 - kTextureFloor) * mean_textured_luminance(scene_, instance, triangle, light.area);
  }
  return kPi * light.area * radiance * (light.two_sided ? 2 : 1);
}

LightSample Lights::sample_triangle(const EmissiveTriangle& light, const Vec3& position,
                                    const Vec2& u_point) const {
  LightSample sample;
  const Vec3 b = square_to_triangle(u_point);
  Vec3 offset = light.p0 + light.edge1 * b.y + light.edge2 * b.z - position;
  const float height = -dot(light.normal, offset);
  if (light.two_sided ? height == 0 : height <= 0) return sample;
  offset += light.normal * std::copysign(light.offset, height);
  const float distance2 = dot(offset, offset);
  if (!(distance2 > 0)) return sample;
  sample.distance = std::sqrt(distance2);
  sample.direction = offset * (1 / sample.distance);
  const float cos_light = -dot(light.normal, sample.direction);
  if (std::signbit(cos_light) != std::signbit(height)) return sample;  // nearer than its offset
  sample.pdf = distance2 / (light.area * std::fabs(cos_light));
  if (!std::isfinite(sample.pdf)) {
    sample.pdf = 0;
    return sample;
  }
  sample.light_group = light.light_group;
  sample.radiance = light.emission;
  if (light.textured) {
    Rgb albedo;
    evaluate_appearance(scene_, light.instance, light.triangle, b.y, b.z, 0, &albedo,
                        &sample.radiance);
  }
  return sample;
}

LightSample Lights::sample_punctual(const scene::PunctualLight& light, const Vec3& position) const {
  LightSample sample;
  sample.delta = true;
  sample.light_group = light.light_group;
  if (light.kind == scene::LightKind::Directional) {
    sample.direction = -light.direction;
    sample.distance = INFINITY;
    sample.radiance = light.intensity;
    sample.pdf = 1;
    return sample;
  }
  const Vec3 offset = light.position - origin_ - position;
  const float distance2 = dot(offset, offset);
  if (!(distance2 > 0)) return sample;
  sample.distance = std::sqrt(distance2);
  sample.direction = offset / sample.distance;
  float factor = range_window(sample.distance, light.range) / distance2;
  if (light.kind == scene::LightKind::Spot) factor *= spot_factor(light, sample.direction);
  if (!(factor > 0) || !std::isfinite(factor)) return sample;
  sample.radiance = light.intensity * factor;
  sample.pdf = 1;
  return sample;
}

LightSample Lights::sample_in_frame(const Vec3& position, double u_choice,
                                    const Vec2& u_point) const {
  if (table_.empty()) return {};
  float probability = 0;
  const uint32_t index = table_.sample(u_choice, &probability);
  LightSample sample = index < triangles_.size()
                           ? sample_triangle(triangles_[index], position, u_point)
                           : sample_punctual(scene_.lights[index - triangles_.size()], position);
  sample.pdf *= probability;
  return sample;
}

}  // namespace lte::pathtrace
