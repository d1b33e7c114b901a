#include "lte/pathtrace/lights/lights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lte/base/check.h"
#include "lte/pathtrace/blocks/square_to_triangle.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights/punctual_lights.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {
namespace {

/// Texture taps a side of the grid that estimates the mean emission of a textured triangle.
constexpr int kTaps = 4;

/// Emitters beyond which a tree draws them: its walk costs about as much as a shadow ray, and
/// halves the variance where some are near and others far. A lamp of two triangles needs none.
constexpr size_t kTreeThreshold = 2;

/// Share of a textured triangle's weight that ignores the texture, so that a bright texel between
/// the taps is still drawn. The estimate stays unbiased whatever the weights are, as long as no
/// emitting point has weight zero.
constexpr double kTextureFloor = 0.1;

/// Limits of the share of draws that an environment gets beside other lights.
constexpr double kMinShare = 0.1, kMaxShare = 0.5;

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

}  // namespace

Lights::Lights(const scene::Scene& scene, LightChoice choice)
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
  if (choice == LightChoice::EachGroup) equalize_groups(&weights);
  if (scene.environment) add_environment(bounds, choice, weights);
  uses_tree_ = choice == LightChoice::Tree ||
               (choice == LightChoice::Automatic && weights.size() > kTreeThreshold);
  if (uses_tree_) build_tree(weights);
  table_ = AliasTable(weights);
  only_plain_triangles_ = scene.lights.empty() && !table_.empty();
  for (const EmissiveTriangle& t : triangles_) {
    only_plain_triangles_ = only_plain_triangles_ && !t.textured;
    triangle_lights_.push_back({t.p0, t.edge1, t.edge2, t.normal, t.emission, t.area, t.offset,
                                t.two_sided ? 1.0f : 0.0f});
  }
  if (table_.empty()) {  // all black or without area: nothing to find by sampling or by hitting
    std::fill(first_of_instance_.begin(), first_of_instance_.end(), -1);
    triangles_.clear();
  }
}

void Lights::add_environment(const Bounds& bounds, LightChoice choice,
                             const std::vector<double>& weights) {
  const scene::Environment& environment = *scene_.environment;
  LTE_CHECK(environment.light_group != scene::kNone, "the environment has no light group");
  groups_ = std::max(groups_, environment.light_group + 1);
  environment_ = EnvironmentSampler(environment);
  const double others = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (environment_.black()) return;
  if (!(others > 0)) {
    environment_share_ = 1;
  } else if (choice == LightChoice::EachGroup) {
    environment_share_ = static_cast<float>(1 / (1 + others));
  } else {
    const double radius = length(bounds.extent()) / 2;
    const double power = kPi * radius * radius * environment_.luminance();
    environment_share_ =
        static_cast<float>(std::clamp(power / (power + others), kMinShare, kMaxShare));
  }
}

void Lights::equalize_groups(std::vector<double>* weights) const {
  const auto group_of = [this](size_t i) {
    const int group = i < triangles_.size() ? triangles_[i].light_group
                                            : scene_.lights[i - triangles_.size()].light_group;
    return static_cast<size_t>(group);
  };
  std::vector<double> totals(static_cast<size_t>(groups_));
  for (size_t i = 0; i < weights->size(); ++i) totals[group_of(i)] += (*weights)[i];
  for (size_t i = 0; i < weights->size(); ++i) {
    const double total = totals[group_of(i)];
    if (total > 0) (*weights)[i] /= total;
  }
}

void Lights::build_tree(const std::vector<double>& weights) {
  std::vector<LightCluster> clusters(weights.size());
  for (size_t i = 0; i < weights.size(); ++i) {
    LightCluster& cluster = clusters[i];
    if (i < triangles_.size()) {
      const EmissiveTriangle& light = triangles_[i];
      for (const Vec3& corner : {light.p0, light.p0 + light.edge1, light.p0 + light.edge2})
        cluster.bounds.extend(corner);
      cluster.axis = light.normal;
      cluster.two_sided = light.two_sided;
      cluster.cos_e = 0;
      cluster.power = static_cast<float>(weights[i] / (light.two_sided ? 2 * kPi : kPi));
      continue;
    }
    const scene::PunctualLight& light = scene_.lights[i - triangles_.size()];
    cluster.bounds.extend(light.position - origin_);
    if (light.kind == scene::LightKind::Directional) {
      if (weights[i] > 0) directional_.push_back(static_cast<uint32_t>(i));
      continue;
    }
    cluster.power = luminance(light.intensity);
    cluster.axis = light.direction;
    const bool spot = light.kind == scene::LightKind::Spot;
    cluster.cos_o = spot ? 1.0f : -1.0f;
    cluster.cos_e = spot ? std::cos(light.outer_cone) - 1e-4f : 0.0f;
  }
  tree_ = LightTree(clusters);
  const auto count = static_cast<float>(directional_.size());
  directional_share_ = tree_.empty() ? 1.0f : count / (count + 1);
}

/// An entry of the table for the point; false if no light can reach it.
bool Lights::choose(const Vec3& position, const Vec3& normal, double u, uint32_t* index,
                    float* probability, LightTreeWalk* walk) const {
  if (!uses_tree_) {
    *index = table_.sample(u, probability);
    return true;
  }
  if (u < directional_share_) {
    const double place = u / directional_share_ * static_cast<double>(directional_.size());
    *index = directional_[std::min(static_cast<size_t>(place), directional_.size() - 1)];
    *probability = directional_share_ / static_cast<float>(directional_.size());
    return true;
  }
  u = (u - directional_share_) / (1 - directional_share_);
  if (!(walk != nullptr ? walk->sample(u, index, probability)
                        : tree_.sample(position, normal, u, index, probability)))
    return false;
  *probability *= 1 - directional_share_;
  return true;
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

LightSample Lights::sample_environment(const Vec3& normal, const Vec2& u_point) const {
  const EnvironmentSample drawn = environment_.sample(normal, u_point);
  LightSample sample;
  sample.direction = drawn.direction;
  sample.distance = INFINITY;
  sample.radiance = drawn.radiance;
  sample.pdf = environment_share_ * drawn.pdf;
  sample.light_group = environment_.light_group();
  return sample;
}

LightSample Lights::sample_in_frame(const Vec3& position, const Vec3& normal, double u_choice,
                                    const Vec2& u_point) const {
  if (environment_share_ > 0) {
    if (u_choice < environment_share_) return sample_environment(normal, u_point);
    u_choice = (u_choice - environment_share_) / (1 - environment_share_);
  }
  if (table_.empty()) return {};
  float probability = 0;
  uint32_t index = 0;
  if (!choose(position, normal, u_choice, &index, &probability)) return {};
  LightSample sample =
      index < triangles_.size()
          ? sample_triangle(triangles_[index], position, u_point)
          : sample_punctual(scene_.lights[index - triangles_.size()], origin_, position);
  sample.pdf *= probability * (1 - environment_share_);
  return sample;
}

}  // namespace lte::pathtrace
