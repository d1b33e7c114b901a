// Light sampling: emissive triangles by power, and punctual lights.
#pragma once

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
  /// @param u  uniform in [0, 1)
  uint32_t sample(float u, float* probability) const;
  float probability(uint32_t index) const { return probability_[index]; }

 private:
  std::vector<float> threshold_, probability_;
  std::vector<uint32_t> alias_;
};

struct EmissiveTriangle {
  int instance = 0;
  uint32_t triangle = 0;
  float area = 0;           ///< m²
  Vec3 p0, edge1, edge2;    ///< world
  Vec3 normal;              ///< unit, front
  bool two_sided = false;
  int light_group = scene::kNone;
};

/// One sample of light arriving at a point.
struct LightSample {
  Vec3 direction;     ///< unit, towards the light
  float distance = 0; ///< INFINITY for directional lights
  Rgb radiance;       ///< area lights: L; punctual: intensity / distance² (irradiance at normal incidence)
  float pdf = 0;      ///< area: per solid angle; punctual: the discrete probability of having chosen it
  bool delta = false; ///< punctual: hemisphere sampling cannot meet it
  int light_group = scene::kNone;
};

/// The light sampler of a scene. Keeps a reference to it.
class Lights {
 public:
  explicit Lights(const scene::Scene& scene);

  bool empty() const { return table_.empty(); }
  int groups() const { return groups_; }

  /// Draws a light by power and a point on it. pdf 0 means: nothing arrives.
  LightSample sample(const Vec3& position, float u_choice, const Vec2& u_point) const;

  /// Solid-angle pdf with which sample() makes the direction that met `triangle` of `instance` at squared distance
  /// `distance2` under `cos_light` (absolute cosine at the light). 0 if it is not in the table.
  float pdf(int instance, uint32_t triangle, float distance2, float cos_light) const;

 private:
  const scene::Scene& scene_;
  int groups_ = 0;
  std::vector<EmissiveTriangle> triangles_;
  AliasTable table_;                         ///< emissive triangles, then punctual lights
  std::vector<int64_t> first_of_instance_;   ///< index of an instance's first emissive triangle, −1 for none
};

}  // namespace lte::pathtrace
