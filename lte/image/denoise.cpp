#include "lte/image/denoise.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/parallel_each.h"

namespace lte::image {
namespace {

/// Albedo below which a surface's light is not divided by it.
constexpr float kMinAlbedo = 1e-3f;
constexpr int64_t kPixels = 1 << 14;  // that a thread takes at a time

bool is_background(const Image& normal, size_t pixel) {
  const Vec3 n = normal.rgb(pixel);
  return n.x == 0 && n.y == 0 && n.z == 0;
}

/// The light with what a denoiser cannot take set to 0.
Image cleaned(const NoisyPicture& picture) {
  Image out = *picture.light;
  parallel_each(out.pixels.size() / 3, kPixels, [&](size_t i) {
    const bool background = is_background(*picture.normal, i);
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      if (background || !std::isfinite(out.pixels[k])) out.pixels[k] = 0;
    }
  });
  return out;
}

/// Albedo of 1 on every surface: irradiance has no texture, and background is none.
Image white_surfaces(const Image& normal) {
  Image out(normal.width, normal.height, 3);
  parallel_each(out.pixels.size() / 3, kPixels, [&](size_t i) {
    if (!is_background(normal, i)) out.set_rgb(i, {1, 1, 1});
  });
  return out;
}

void multiply(const Image& albedo, bool inverse, Image* light) {
  for (size_t i = 0; i < light->pixels.size(); ++i) {
    const float a = albedo.pixels[i];
    if (a >= kMinAlbedo) light->pixels[i] *= inverse ? 1 / a : a;
  }
}

}  // namespace

Denoiser::Denoiser(DenoiseBy by) {
  std::string why_not;
  if (by != DenoiseBy::Bilateral) oidn_ = Oidn::find(&why_not);
  LTE_CHECK(oidn_ || by != DenoiseBy::OpenImageDenoise,
            "Open Image Denoise was not found: ", why_not);
  if (oidn_) {
    description_ = oidn_->name();
  } else if (by == DenoiseBy::Bilateral) {
    description_ = "lte's bilateral filter";
  } else {
    description_ = "lte's bilateral filter, as Open Image Denoise was not found (" + why_not + ")";
  }
}

Image Denoiser::denoise(const NoisyPicture& picture, OidnQuality quality) const {
  const auto check = [&](const Image* image, const char* what) {
    LTE_CHECK(image != nullptr, "denoising needs ", what);
    LTE_CHECK(image->width == picture.light->width && image->height == picture.light->height &&
                  image->channels == 3,
              what, " of ", image->width, "x", image->height, "x", image->channels, ": expected ",
              picture.light->width, "x", picture.light->height, "x3");
  };
  check(picture.light, "a picture");
  check(picture.normal, "normals");
  if (picture.albedo != nullptr) check(picture.albedo, "albedo");
  Image light = cleaned(picture);
  // Open Image Denoise makes some 1e-6 of nothing, which an automatic exposure would show.
  if (std::all_of(light.pixels.begin(), light.pixels.end(), [](float v) { return v == 0; }))
    return light;
  if (oidn_) {
    const Image albedo = picture.albedo ? *picture.albedo : white_surfaces(*picture.normal);
    light = oidn_->denoise(light, {&albedo, picture.normal}, quality);
    parallel_each(light.pixels.size() / 3, kPixels, [&](size_t i) {
      if (is_background(*picture.normal, i)) light.set_rgb(i, {});
    });
    return light;
  }
  if (picture.albedo != nullptr) multiply(*picture.albedo, /*inverse=*/true, &light);
  light = bilateral_filter(light, {picture.normal, picture.position, picture.variance});
  if (picture.albedo != nullptr) multiply(*picture.albedo, /*inverse=*/false, &light);
  return light;
}

}  // namespace lte::image
