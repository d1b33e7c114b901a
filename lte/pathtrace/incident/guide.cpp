#include "lte/pathtrace/incident/guide.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lte/base/check.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::pathtrace {
namespace {

/// A lobe narrower than this is smeared over as much where the map's cells are weighed: a cell has
/// one direction to stand for all of its own, and would miss the lobe.
constexpr float kLeastCellRoughness = 0.25f;

constexpr float kBelowOne = 1 - 0x1p-24f;

/// What a surface reflects from and to, metal or not.
class Surface {
 public:
  Surface(const Vec3& normal, const Reflector& reflector, float roughness)
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

}  // namespace

struct Guide::State {
  int bins;
  Vec3 normal, tangent, bitangent;
  GuideOptions options;
  Surface surface;
  std::vector<float> share;   ///< [cells] probability of each, which add up to 1
  std::vector<double> below;  ///< [cells] of all up to and with it

  Vec3 to_world(const Vec3& v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
  Vec3 to_local(const Vec3& v) const {
    return {dot(v, tangent), dot(v, bitangent), dot(v, normal)};
  }
  size_t cell_of(const Vec2& place) const {
    const auto at = [this](float x) {
      return std::min(static_cast<int>(x * static_cast<float>(bins)), bins - 1);
    };
    return static_cast<size_t>(at(place.y) * bins + at(place.x));
  }
  /// Solid-angle density of the cells: a cell has a projected solid angle of π / bins².
  float map_pdf(const Vec3& local) const {
    if (!(local.z > 0)) return 0;
    const auto cells = static_cast<float>(share.size());
    return share[cell_of(bin_place(local))] * cells * local.z / kPi;
  }
  Vec3 sample_map(Vec2 u) const {
    const auto found = std::upper_bound(below.begin(), below.end(), double{u.x});
    const auto cell = std::min(static_cast<size_t>(found - below.begin()), share.size() - 1);
    const double before = cell == 0 ? 0 : below[cell - 1];
    const float inside =
        std::clamp(static_cast<float>((u.x - before) / share[cell]), 0.0f, kBelowOne);
    const auto row = static_cast<float>(cell / static_cast<size_t>(bins)),
               column = static_cast<float>(cell % static_cast<size_t>(bins));
    const auto size = static_cast<float>(bins);
    return to_world(bin_direction({(column + inside) / size, (row + u.y) / size}));
  }
};

Guide::Guide(std::span<const Rgb> radiance, int bins, const Vec3& normal,
             const Reflector& reflector, const GuideOptions& options) {
  const size_t cells = radiance.size();
  LTE_CHECK(bins >= 2 && bins % 2 == 0 && cells == static_cast<size_t>(bins) * bins,
            "a guide needs an even number of bins and their square of cells, got ", bins, " and ",
            cells);
  LTE_CHECK(options.even_share > 0 && options.even_share <= 1,
            "a guide's even share must lie in (0, 1], got ", options.even_share);
  LTE_CHECK(options.material_share >= 0 && options.material_share < 1,
            "a guide's material share must lie in [0, 1), got ", options.material_share);
  const Vec3 tangent = bin_tangent(normal);
  state_ = std::make_unique<State>(State{bins, normal, tangent, cross(normal, tangent), options,
                                         Surface(normal, reflector, reflector.gloss.roughness),
                                         std::vector<float>(cells), std::vector<double>(cells)});
  State& s = *state_;
  const Surface smeared(normal, reflector,
                        std::max(reflector.gloss.roughness, kLeastCellRoughness));
  double sum = 0;
  std::vector<double> weight(cells);
  for (size_t i = 0; i < cells; ++i) {
    const Rgb& light = radiance[i];
    LTE_CHECK(is_finite(light) && light.x >= 0 && light.y >= 0 && light.z >= 0,
              "a guide's radiance must be finite and not negative, in cell ", i);
    const auto centre = [bins](size_t at) {
      return (static_cast<float>(at) + 0.5f) / static_cast<float>(bins);
    };
    const auto n = static_cast<size_t>(bins);
    const Vec3 local = bin_direction({centre(i % n), centre(i / n)});
    // f per projected solid angle, as cells have equal ones.
    weight[i] = luminance(light * smeared.evaluate(s.to_world(local)).value) / local.z;
    sum += weight[i];
  }
  const double even = sum > 0 ? double{options.even_share} : 1;
  double below = 0;
  for (size_t i = 0; i < cells; ++i) {
    const double share =
        even / static_cast<double>(cells) + (sum > 0 ? (1 - even) * weight[i] / sum : 0);
    s.share[i] = static_cast<float>(share);
    s.below[i] = below += share;
  }
}

Guide::~Guide() = default;
Guide::Guide(Guide&&) noexcept = default;

float Guide::pdf(const Vec3& direction) const {
  const State& s = *state_;
  const float material = s.options.material_share;
  return material * s.surface.evaluate(direction).pdf +
         (1 - material) * s.map_pdf(s.to_local(direction));
}

Rgb Guide::reflected(const Vec3& direction) const {
  return state_->surface.evaluate(direction).value;
}

Guide::Draw Guide::draw(Vec2 u) const {
  const State& s = *state_;
  const float material = s.options.material_share;
  Draw out;
  out.direction = s.normal;
  Vec3 direction;
  if (u.x < material) {
    u.x = std::min(u.x / material, kBelowOne);
    float drawn = 0;
    direction = s.surface.sample(u, &drawn);
    if (!(drawn > 0)) return out;
  } else {
    u.x = std::min((u.x - material) / (1 - material), kBelowOne);
    direction = s.sample_map(u);
  }
  const float density = pdf(direction);
  if (!(density > 0) || !(dot(direction, s.normal) > 0)) return out;
  out.direction = direction;
  out.pdf = density;
  out.weight = reflected(direction) / density;
  return out;
}

}  // namespace lte::pathtrace
