// Light sampling: emissive triangles by power, and punctual lights.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// Walker/Vose alias table: O(1) draws from a discrete distribution.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights);
  bool empty() const { return probability_.empty(); }
  size_t size() const { return probability_.size(); }
  /// @param u  uniform in [0, 1), of 32 bits: with fewer, tables of millions of entries would be
  /// drawn unevenly
  uint32_t sample(double u, float* probability) const {
    const double position = u * static_cast<double>(size());
    const auto cell = std::min(static_cast<uint32_t>(position), static_cast<uint32_t>(size() - 1));
    const uint32_t index = position - cell < threshold_[cell] ? cell : alias_[cell];
    *probability = probability_[index];
    return index;
  }
  float probability(uint32_t index) const { return probability_[index]; }

 private:
  std::vector<float> threshold_, probability_;
  std::vector<uint32_t> alias_;
};

struct EmissiveTriangle {
  int instance = 0;
  uint32_t triangle = 0;
  float area = 0;         ///< m²
  Vec3 p0, edge1, edge2;  ///< world axes, relative to frame_origin()
  Vec3 normal;            ///< unit, front
  float offset =
      0;         ///< distance off the surface at which shadow rays end, so that they do not meet it
  Rgb emission;  ///< factor; the whole of it unless `textured`
  bool textured = false;
  bool two_sided = false;
  int light_group = scene::kNone;
};

/// One sample of light arriving at a point.
struct LightSample {
  Vec3 direction;      ///< unit, towards the light
  float distance = 0;  ///< INFINITY for directional lights
  Rgb radiance;        ///< area lights: L; punctual: intensity / distance² (irradiance at normal
                       ///< incidence)
  float pdf = 0;  ///< area: per solid angle; punctual: the discrete probability of having chosen it
  bool delta = false;  ///< punctual: hemisphere sampling cannot meet it
  int light_group = scene::kNone;
};

/// The light sampler of a scene. Keeps a reference to it, which must outlive it. Black lights are
/// left out, so they are never sampled. Thread-safe.
class Lights {
 public:
  /// @throws lte::Error if an emissive instance or a punctual light has no light group.
  explicit Lights(const scene::Scene& scene);

  bool empty() const { return table_.empty(); }
  bool has_area_lights() const { return !triangles_.empty(); }
  int groups() const { return groups_; }
  const scene::Scene& scene() const { return scene_; }

  /// Draws a light by power and a point on it. pdf 0 means: nothing arrives.
  LightSample sample(const Vec3& position, double u_choice, const Vec2& u_point) const {
    return sample_in_frame(position - origin_, u_choice, u_point);
  }

  /// The same for a position relative to frame_origin(): what paths use.
  LightSample sample_in_frame(const Vec3& position, double u_choice, const Vec2& u_point) const;

  /// Solid-angle pdf with which sample() makes the direction that met `triangle` of `instance` at
  /// squared distance `distance2` under `cos_light` (absolute cosine at the light). 0 if it is not
  /// in the table.
  float pdf(int instance, uint32_t triangle, float distance2, float cos_light) const {
    const int64_t first = first_of_instance_[instance];
    if (first < 0) return 0;
    const auto index = static_cast<uint32_t>(first + triangle);
    return table_.probability(index) * distance2 / (triangles_[index].area * cos_light);
  }

 private:
  double add_triangle(int instance, uint32_t triangle);
  LightSample sample_triangle(const EmissiveTriangle& light, const Vec3& position,
                              const Vec2& u_point) const;
  LightSample sample_punctual(const scene::PunctualLight& light, const Vec3& position) const;

  const scene::Scene& scene_;
  Vec3 origin_;
  int groups_ = 0;
  std::vector<EmissiveTriangle> triangles_;
  AliasTable table_;  ///< emissive triangles, then punctual lights
  std::vector<int64_t>
      first_of_instance_;  ///< index of an instance's first emissive triangle, −1 for none
};

}  // namespace lte::pathtrace
