#include "experiments/guiding/guide.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lte/base/check.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::experiments {

using namespace pathtrace;

/// What a surface reflects from and to, metal or not.
class GuidedSurface {
 public:
  GuidedSurface(const Vec3& normal, const Reflector& reflector, float roughness)
      : color_(reflector.color), normal_(normal) {
    if (reflector.gloss.metallic > 0)
      glossy_.emplace(reflector.color, reflector.gloss.metallic, roughness, normal,
                      reflector.outgoing);
  }
  Scattering evaluate(const Vec3& incident) const {
    if (glossy_) return glossy_->evaluate(incident);
    const float pdf = lambert_pdf(std::max(0.0f, dot(normal_, incident)));
    return {color_ * pdf, pdf};
  }
  Vec3 sample(const Vec2& u, float* pdf) const {
    if (!glossy_) return sample_lambert(normal_, u, pdf);
    const ScatteringSample out = glossy_->sample(u);
    *pdf = out.pdf;
    return out.direction;
  }

 private:
  Rgb color_;
  Vec3 normal_;
  std::optional<GlossyBsdf> glossy_;
};

namespace {

/// A lobe narrower than this is smeared over as much where the map's cells are weighed: a cell has
/// one direction to stand for all of its own, and would miss the lobe.
constexpr float kMinCellRoughness = 0.25f;

/// Cosine between normals of one hemisphere.
constexpr float kSameWay = 0.99999f;

/// Cells in proportion to radiance times what the surface reflects.
std::shared_ptr<const GuideTable> product_table(const DirectionMap& map, const Vec3& normal,
                                                const Reflector& reflector, float even_share) {
  const GuidedSurface smeared(normal, reflector,
                              std::max(reflector.gloss.roughness, kMinCellRoughness));
  return std::make_shared<GuideTable>(map, even_share, [&](const Vec3& direction) {
    // f per projected solid angle, as cells have equal ones.
    return smeared.evaluate(direction).value / dot(direction, map.normal);
  });
}

}  // namespace

struct Guide::State {
  std::shared_ptr<const GuideTable> table;
  Vec3 normal;
  float material_share;
  GuidedSurface surface;
};

Guide::Guide(std::shared_ptr<const GuideTable> table, const Vec3& normal,
             const Reflector& reflector, float material_share) {
  LTE_CHECK(material_share >= 0 && material_share < 1,
            "a guide's material share must lie in [0, 1), got ", material_share);
  LTE_CHECK(material_share > 0 || table->height(normal) > kSameWay,
            "a guide around another normal needs a material share above 0");
  state_ =
      std::make_unique<State>(State{std::move(table), normal, material_share,
                                    GuidedSurface(normal, reflector, reflector.gloss.roughness)});
}

Guide::Guide(const DirectionMap& map, const Vec3& normal, const Reflector& reflector,
             const GuideOptions& options)
    : Guide(product_table(map, normal, reflector, options.even_share), normal, reflector,
            options.material_share) {}

Guide::~Guide() = default;
Guide::Guide(Guide&&) noexcept = default;

float Guide::pdf(const Vec3& direction) const {
  const State& s = *state_;
  const float material = s.material_share;
  return material * s.surface.evaluate(direction).pdf + (1 - material) * s.table->pdf(direction);
}

Rgb Guide::reflected(const Vec3& direction) const {
  return state_->surface.evaluate(direction).value;
}

Guide::Draw Guide::draw(Vec2 u) const {
  const State& s = *state_;
  Draw out;
  out.direction = s.normal;
  Vec3 direction;
  if (takes_first(s.material_share, &u.x)) {
    float drawn = 0;
    direction = s.surface.sample(u, &drawn);
    if (!(drawn > 0)) return out;
  } else {
    direction = s.table->sample(u);
  }
  const float density = pdf(direction);
  if (!(density > 0) || !(dot(direction, s.normal) > 0)) return out;
  out.direction = direction;
  out.pdf = density;
  out.weight = reflected(direction) / density;
  return out;
}

}  // namespace lte::experiments
