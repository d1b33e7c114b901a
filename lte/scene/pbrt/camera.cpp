// Camera and Film directives.
#include <cmath>

#include "lte/scene/pbrt/world.h"

namespace lte::scene::pbrt {
namespace {

/// The window on the image plane at distance 1 / tan(fov / 2): x0 x1 y0 y1.
std::array<double, 4> screen_window(const Params& params, const Params* film) {
  const std::vector<float> given = params.numbers("screenwindow");
  if (!given.empty()) {
    if (given.size() != 4)
      fail(params.at(), params.what(), ": \"screenwindow\" takes 4 numbers, got ", given.size());
    if (!(given[0] < given[1] && given[2] < given[3]))
      fail(params.at(), params.what(), ": \"screenwindow\" is empty");
    return {given[0], given[1], given[2], given[3]};
  }
  int width = 1280, height = 720;  // pbrt's defaults
  if (film != nullptr) {
    width = film->integer("xresolution", width);
    height = film->integer("yresolution", height);
    if (width <= 0 || height <= 0)
      fail(film->at(), film->what(), ": its resolution must be positive, got ", width, " x ",
           height);
  }
  const double aspect = params.number("frameaspectratio", static_cast<double>(width) / height);
  if (!(aspect > 0))
    fail(params.at(), params.what(), ": \"frameaspectratio\" must be positive, got ", aspect);
  return aspect > 1 ? std::array<double, 4>{-aspect, aspect, -1, 1}
                    : std::array<double, 4>{-1, 1, -1 / aspect, 1 / aspect};
}

Vec3 column(const Transform& t, size_t index) {
  return {static_cast<float>(t.m[0][index]), static_cast<float>(t.m[1][index]),
          static_cast<float>(t.m[2][index])};
}

}  // namespace

std::optional<Camera> build_camera(const std::string& type, const Params& params,
                                   const Transform& world_to_camera, const Params* film,
                                   IgnoredFeatures* ignored) {
  if (type != "perspective") {
    ignored->add("Camera " + quote(type), params.at());
    return std::nullopt;
  }
  const Transform to_world = inverse(world_to_camera, params.at());
  to_affine(to_world, params.at());
  const Vec3 right = column(to_world, 0), up = column(to_world, 1), ahead = column(to_world, 2);
  Camera out;
  out.name = "camera";
  out.origin = column(to_world, 3);
  out.target = out.origin + normalize(ahead);
  out.up = normalize(up);
  // Our cameras have right = ahead x up. pbrt's frame is left-handed, so its picture is the mirror
  // image of that unless the scene mirrors space itself, as most do ("Scale -1 1 1").
  const Vec3 ours = cross(ahead, up);
  out.mirrored = dot(ours, right) < 0;
  const auto fov = params.number("fov", 90);
  if (!(fov > 0 && fov < 180))
    fail(params.at(), params.what(), ": \"fov\" must be between 0 and 180 degrees, got ", fov);
  const std::array<double, 4> window = screen_window(params, film);
  const double stretch = length(up) / length(ahead);
  const double half = std::tan(fov * (M_PI / 360)) * (window[3] - window[2]) / 2 * stretch;
  out.vfov = static_cast<float>(2 * std::atan(half) * (180 / M_PI));
  if (!(out.vfov > 0 && out.vfov < 180) || length(out.target - out.origin) == 0)
    fail(params.at(), params.what(), ": has no usable field of view");

  const double tolerance = 1e-4 * (window[1] - window[0]);
  if (std::abs(window[0] + window[1]) > tolerance || std::abs(window[2] + window[3]) > tolerance)
    ignored->add("screenwindow off the middle: the camera looks through its middle", params.at());
  const float skew = std::abs(dot(right, up)) / (length(right) * length(up)) +
                     std::abs(dot(ahead, up)) / (length(ahead) * length(up)) +
                     std::abs(length(right) / length(up) - 1);
  if (skew > 1e-3f) ignored->add("camera transform with skew or uneven scale", params.at());
  if (params.number("lensradius", 0) > 0)
    ignored->add("lens of the camera: a pinhole is taken", params.at());
  for (const char* harmless : {"focaldistance", "shutteropen", "shutterclose"})
    params.has(harmless);
  ignore_unused(params, ignored);
  return out;
}

}  // namespace lte::scene::pbrt
