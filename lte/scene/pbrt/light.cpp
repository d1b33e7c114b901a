// LightSource directives.
#include <algorithm>
#include <cmath>

#include "lte/scene/pbrt/named_spectra.h"
#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {
namespace {

constexpr double kDegree = M_PI / 180;

/// "from" and "to" brought into the world.
struct Aim {
  Vec3 origin, direction;
};

Aim aim(const Params& params, const Affine& to_world) {
  const Vec3 from = params.point("from", {0, 0, 0}), to = params.point("to", {0, 0, 1});
  const Vec3 along = to_world.vector(to - from);
  if (!(length(along) > 0) || !is_finite(along))
    fail(params.at(), params.what(), ": \"from\" and \"to\" must differ");
  return {to_world.point(from), normalize(along)};
}

/// pbrt-v4's "power" and "illuminance": where given, the color is scaled by it over what a source
/// of unit strength has. The magnitude of an rgb color stays in, as it does there.
void scale_to(const Params& params, const std::string& name, double unit, Rgb* color) {
  const double wanted = params.number(name, -1);
  if (wanted > 0) *color *= static_cast<float>(wanted / unit);
}

}  // namespace

Rgb light_color(const Params& params, const std::string& name, const Files& files,
                IgnoredFeatures* ignored) {
  const Parameter* parameter = params.find(name);
  const Rgb rgb = parameter != nullptr ? to_illuminant(*parameter, files, ignored) : Rgb{1, 1, 1};
  return rgb * static_cast<float>(params.number("scale", 1));
}

std::optional<PunctualLight> build_light(const std::string& type, const Params& params,
                                         const Transform& to_world, const Files& files,
                                         IgnoredFeatures* ignored) {
  if (type != "point" && type != "spot" && type != "distant") {
    ignored->add(type == "goniometric" || type == "projection"
                     ? "LightSource " + quote(type) + ": not supported, ignored"
                     : "unknown LightSource " + quote(type),
                 params.at());
    return std::nullopt;
  }
  const Affine affine = to_affine(to_world, params.at());
  PunctualLight out;
  out.name = concat(type, " light ", params.at());
  if (type == "point") {
    out.position = affine.point(params.point("from", {0, 0, 0}));
    out.intensity = light_color(params, "I", files, ignored);
    scale_to(params, "power", 4 * M_PI, &out.intensity);
  } else if (type == "distant") {
    const Aim line = aim(params, affine);
    out.kind = LightKind::Directional;
    out.direction = line.direction;
    out.intensity = light_color(params, "L", files, ignored);
    scale_to(params, "illuminance", 1, &out.intensity);
  } else {
    const Aim line = aim(params, affine);
    const double cone = params.number("coneangle", 30), delta = params.number("conedeltaangle", 5);
    if (!(cone > 0 && cone <= 180))
      fail(params.at(), params.what(), ": \"coneangle\" must be in (0, 180], got ", cone);
    const double inner = std::clamp(cone - delta, 0.0, cone);
    out.kind = LightKind::Spot;
    out.position = line.origin;
    out.direction = line.direction;
    out.outer_cone = static_cast<float>(cone * kDegree);
    out.inner_cone = static_cast<float>(inner * kDegree);
    out.intensity = light_color(params, "I", files, ignored);
    const double start = std::cos(inner * kDegree), end = std::cos(cone * kDegree);
    scale_to(params, "power", 2 * M_PI * ((1 - start) + (start - end) / 2), &out.intensity);
    if (inner < cone)
      ignored->add("spot light: its smoothstep falloff becomes the square of a linear one",
                   params.at());
  }
  ignore_unused(params, ignored);
  if (!is_finite(out.position) || !is_finite(out.intensity))
    fail(params.at(), params.what(), ": its position or intensity is not finite");
  if (out.intensity.x < 0 || out.intensity.y < 0 || out.intensity.z < 0)
    fail(params.at(), params.what(), ": its intensity is negative");
  return out;
}

}  // namespace lte::scene::pbrt
