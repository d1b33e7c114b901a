// Internal: reflection at a surface that is metal wholly or in part.
//
// metallic × GGX conductor (ggx.h) + (1 − metallic) × Lambert (lambert.h), both of one color: the
// conductor's reflectance at normal incidence and the albedo. There is no dielectric coat on the
// latter.
#pragma once

#include <algorithm>

#include "lte/base/math.h"
#include "lte/pathtrace/materials/bsdf.h"
#include "lte/pathtrace/materials/ggx.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::pathtrace {

class GlossyBsdf {
 public:
  /// @param color     [0, 1]
  /// @param metallic  (0, 1]
  /// @param normal    unit, of the side that `outgoing` is on; a shading normal may face away
  /// @param outgoing  unit, away from the surface: where the light goes
  GlossyBsdf(const Rgb& color, float metallic, float roughness, const Vec3& normal,
             const Vec3& outgoing)
      : color_(color), metallic_(metallic), alpha_(ggx_alpha(roughness)), normal_(normal) {
    make_frame(normal, &tangent_, &bitangent_);
    outgoing_ = to_local(outgoing);
    if (outgoing_.z < 0) outgoing_ = normalize({outgoing_.x, outgoing_.y, 0});  // grazing
  }

  /// @param incident  unit, away from the surface: where the light comes from
  Scattering evaluate(const Vec3& incident) const { return evaluate_local(to_local(incident)); }

  ScatteringSample sample(Vec2 u) const {
    ScatteringSample out;
    Vec3 local;
    if (u.x < metallic_) {
      u.x = std::min(u.x / metallic_, kBelowOne);
      const Vec3 h = sample_visible_normal(outgoing_, alpha_, u);
      local = h * (2 * dot(outgoing_, h)) - outgoing_;
    } else {
      u.x = std::min((u.x - metallic_) / (1 - metallic_), kBelowOne);
      float pdf;
      local = sample_lambert({0, 0, 1}, u, &pdf);
    }
    const Scattering scattering = evaluate_local(local);
    if (!(scattering.pdf > 0)) return out;
    out.direction = tangent_ * local.x + bitangent_ * local.y + normal_ * local.z;
    out.weight = scattering.value / scattering.pdf;
    out.pdf = scattering.pdf;
    return out;
  }

 private:
  static constexpr float kBelowOne = 1 - 0x1p-24f;

  Vec3 to_local(const Vec3& v) const {
    return {dot(v, tangent_), dot(v, bitangent_), dot(v, normal_)};
  }

  Scattering evaluate_local(const Vec3& incident) const {
    Scattering out;
    if (!(incident.z > 0)) return out;
    const float lambert = lambert_pdf((1 - metallic_) * incident.z);
    const Vec3 h = normalize(outgoing_ + incident);
    const float mirrors =
        ggx_distribution(h, alpha_) * ggx_visibility_cosine(outgoing_, incident, alpha_);
    out.value = color_ * lambert + schlick(color_, dot(incident, h)) * (metallic_ * mirrors);
    out.pdf = lambert + metallic_ * ggx_reflection_pdf(outgoing_, h, alpha_);
    return out;
  }

  Rgb color_;
  float metallic_, alpha_;
  Vec3 normal_, tangent_, bitangent_, outgoing_;
};

}  // namespace lte::pathtrace
