// LightSource "infinite": constant radiance, or a picture of all directions.
#include <algorithm>
#include <cmath>

#include "lte/image/tonemap.h"
#include "lte/scene/pbrt/named_file.h"
#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {
namespace {

constexpr double kOrthogonal = 1e-3;  ///< cosine between axes that is still taken for rounding

/// The light's axes in the world, scaled to unit length. pbrt looks directions up through the
/// inverse of its transform; for rotations, mirrors and uniform scales that is the same.
std::array<Vec3, 3> world_axes(const Transform& to_world, const Params& params,
                               IgnoredFeatures* ignored) {
  const Affine affine = to_affine(to_world, params.at());
  std::array<Vec3, 3> axes{normalize(affine.vector({1, 0, 0})), normalize(affine.vector({0, 1, 0})),
                           normalize(affine.vector({0, 0, 1}))};
  const float skew = std::max({std::fabs(dot(axes[0], axes[1])), std::fabs(dot(axes[1], axes[2])),
                               std::fabs(dot(axes[2], axes[0]))});
  const float lengths[3] = {length(affine.vector({1, 0, 0})), length(affine.vector({0, 1, 0})),
                            length(affine.vector({0, 0, 1}))};
  const auto [least, most] = std::minmax({lengths[0], lengths[1], lengths[2]});
  if (skew > kOrthogonal || least < most * (1 - kOrthogonal))
    ignored->add("infinite light: its transform stretches or shears, only its rotation is taken",
                 params.at());
  // Gram-Schmidt; the third keeps its hand.
  axes[1] = normalize(axes[1] - axes[0] * dot(axes[0], axes[1]));
  const Vec3 third = cross(axes[0], axes[1]);
  axes[2] = dot(third, axes[2]) < 0 ? -third : third;
  return axes;
}

/// pbrt-v3 had longitude and latitude around +Z, from +X on: our equirectangular frame has its Y
/// there, and its middle at -X.
std::array<Vec3, 3> latitude_axes(const std::array<Vec3, 3>& axes) {
  return {-axes[0], axes[2], -axes[1]};
}

/// Linear radiance, three channels.
image::Image read_radiance(const std::string& name, const Params& params, const Files& files) {
  const SceneFilePtr file = files.find(name, params.at());
  const image::DeclaredSize size = declared_size(*file, params.at());
  files.budget().add_pictures({{concat(params.at(), ": ", file->name()), size.width, size.height}},
                              kEnvironmentBytes);
  const image::Picture picture = decode_picture(
      *file, params.at(), std::min(files.limits().texture_pixels, EnvironmentMap::kMaxTexels));
  const image::Image& source = picture.image;
  image::Image out(source.width, source.height, 3);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = source.at(x, y)[source.channels >= 3 ? c : 0];
        if (!std::isfinite(value))
          fail(params.at(), file->name(), ": pixel ", x, ", ", y, " is not finite");
        out.at(x, y)[c] = std::max(0.0f, picture.coded ? image::srgb_to_linear(value) : value);
      }
    }
  }
  return out;
}

/// What pbrt-v4 holds against "illuminance": its sum over the upper half (+Z) of the picture, which
/// weighs a texel with half of its solid angle, so that a picture comes out twice as bright as
/// asked for. Scenes are made to look right in pbrt.
double pbrt_illuminance(const image::Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 w = equal_area_direction((x + 0.5) / image.width, (y + 0.5) / image.height);
      if (w.z > 0) sum += static_cast<double>(luminance(image.rgb(x, y))) * w.z;
    }
  }
  return sum * 2 * M_PI / (double{1} * image.width * image.height);
}

/// @param latitude  pbrt-v3's mapping, and its "L", which scales the picture
void add_picture(const std::string& file, bool latitude, const Params& params,
                 const Transform& to_world, const Files& files, IgnoredFeatures* ignored,
                 InfiniteLight* light) {
  image::Image picture = read_radiance(file, params, files);
  if (!latitude && picture.width != picture.height)
    fail(params.at(), params.what(), ": ", quote(file), " is ", picture.width, "x", picture.height,
         "; pbrt-v4 has square pictures, of its equal-area mapping");
  Rgb factor = latitude ? light_color(params, "L", files, ignored)
                        : Rgb{1, 1, 1} * static_cast<float>(params.number("scale", 1));
  const double wanted = params.number("illuminance", -1);
  if (wanted > 0 && !latitude) {
    const double there = pbrt_illuminance(picture);
    if (!(there > 0))
      fail(params.at(), params.what(), ": \"illuminance\" of a picture whose upper half is black");
    factor *= static_cast<float>(wanted / there);
  }
  if (factor.x < 0 || factor.y < 0 || factor.z < 0)
    fail(params.at(), params.what(), ": its radiance is negative");
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    float& value = picture.pixels[i];
    value *= factor[static_cast<int>(i % 3)];
    if (!std::isfinite(value)) fail(params.at(), params.what(), ": its radiance is not finite");
  }
  light->picture = std::move(picture);
  light->axes = world_axes(to_world, params, ignored);
  light->mapping = latitude ? SphereMapping::Equirectangular : SphereMapping::EqualArea;
  if (latitude) light->axes = latitude_axes(light->axes);
}

}  // namespace

void add_infinite_light(const Params& params, const Transform& to_world, const Files& files,
                        IgnoredFeatures* ignored, std::optional<InfiniteLight>* lights) {
  const std::string square = params.text("filename", ""), latitude = params.text("mapname", "");
  const std::string& file = square.empty() ? latitude : square;
  if (!square.empty() && params.has("L"))
    fail(params.at(), params.what(), " has both \"L\" and \"filename\"");
  if (params.has("portal"))
    ignored->add("portal of an infinite light: its light comes from all directions", params.at());
  for (const char* harmless : {"nsamples", "samples"}) params.has(harmless);
  InfiniteLight light = lights->value_or(InfiniteLight{});
  if (file.empty()) {
    Rgb color = light_color(params, "L", files, ignored);
    const double illuminance = params.number("illuminance", -1);
    if (illuminance > 0) color *= static_cast<float>(illuminance / M_PI);
    if (!is_finite(color) || color.x < 0 || color.y < 0 || color.z < 0)
      fail(params.at(), params.what(), ": its radiance is negative or not finite");
    light.constant += color;
  } else if (light.picture) {
    ignored->add("second infinite light with a picture: ignored", params.at());
  } else {
    add_picture(file, square.empty(), params, to_world, files, ignored, &light);
  }
  ignore_unused(params, ignored);
  *lights = std::move(light);
}

Environment to_environment(InfiniteLight light) {
  Environment out;
  if (!light.picture) {
    out.radiance = light.constant;
    return out;
  }
  out.radiance = {1, 1, 1};
  out.axes = light.axes;
  std::vector<float>& pixels = light.picture->pixels;
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] += light.constant[static_cast<int>(i % 3)];
  out.map = std::make_shared<const EnvironmentMap>(*light.picture, light.mapping);
  return out;
}

}  // namespace lte::scene::pbrt
