#include "datagen/common/cie_sky.h"

#include <algorithm>
#include <cmath>

#include "datagen/common/raster.h"

namespace lte::datagen {
namespace {

/// Fine enough for the glow around a sun, which falls by a factor e in 20 degrees; the sun itself
/// is a light of its own.
constexpr int kWidth = 64, kHeight = 32;

Vec3 texel_direction(int x, int y) {
  const double polar = M_PI * (y + 0.5) / kHeight, turn = 2 * M_PI * ((x + 0.5) / kWidth - 0.5);
  return {static_cast<float>(std::sin(polar) * std::cos(turn)), static_cast<float>(std::cos(polar)),
          static_cast<float>(std::sin(polar) * std::sin(turn))};
}

/// Σ of this over a row's texels, times a radiance of 1, is what a roof gets from them.
double row_weight(int y) {
  const double low = std::sin(M_PI * y / kHeight), high = std::sin(M_PI * (y + 1) / kHeight);
  return M_PI * (high * high - low * low) / kWidth;
}

double gradation(const CieSky& sky, double cosine) {
  return 1 + sky.a * std::exp(sky.b / std::max(cosine, 1e-3));
}

double indicatrix(const CieSky& sky, double cosine) {
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  return 1 + sky.c * (std::exp(sky.d * angle) - std::exp(sky.d * M_PI / 2)) +
         sky.e * cosine * cosine;
}

}  // namespace

double relative_luminance(const CieSky& sky, const Vec3& direction, const Vec3& sun) {
  return indicatrix(sky, dot(direction, sun)) * gradation(sky, direction.y) /
         (indicatrix(sky, sun.y) * gradation(sky, 1));
}

std::shared_ptr<const scene::EnvironmentMap> sky_picture(const CieSky& sky, const Vec3& sun,
                                                         const Rgb& zenith, const Rgb& horizon,
                                                         const Rgb& ground) {
  image::Image picture(kWidth, kHeight, 3);
  double on_roof = 0;
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 direction = texel_direction(x, y);
      const Rgb tint = mix(zenith, horizon, std::pow(1 - direction.y, 3.0f));
      const auto level = static_cast<float>(relative_luminance(sky, direction, sun));
      picture.set_rgb(x, y, tint * level);
      on_roof += luminance(picture.rgb(x, y)) * row_weight(y);
    }
  }
  const auto scale = static_cast<float>(M_PI / on_roof);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      picture.set_rgb(x, y, y < kHeight / 2 ? picture.rgb(x, y) * scale : ground);
  return std::make_shared<scene::EnvironmentMap>(picture, scene::SphereMapping::Equirectangular);
}

}  // namespace lte::datagen
