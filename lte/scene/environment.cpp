#include "lte/scene/environment.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::scene {
namespace {

int cell(double place, int count) {
  return std::clamp(static_cast<int>(place * count), 0, count - 1);
}

}  // namespace

Vec3 equal_area_direction(double u, double v) {
  const double x = 2 * u - 1, y = 2 * v - 1;
  const double from_diagonal = 1 - (std::fabs(x) + std::fabs(y));  // positive in the upper half
  const double r = 1 - std::fabs(from_diagonal);
  const double phi = r == 0 ? M_PI / 4 : ((std::fabs(y) - std::fabs(x)) / r + 1) * M_PI / 4;
  const double across = r * std::sqrt(2 - r * r);
  return {static_cast<float>(std::copysign(std::cos(phi) * across, x)),
          static_cast<float>(std::copysign(std::sin(phi) * across, y)),
          static_cast<float>(std::copysign(1 - r * r, from_diagonal))};
}

Vec2 equal_area_point(const Vec3& direction) {
  const double x = direction.x, y = direction.y, z = direction.z;
  // sqrt(1 - |z|), without its cancellation at the poles.
  const double r = std::sqrt((x * x + y * y) / (1 + std::fabs(z)));
  const double turn = std::atan2(std::fabs(y), std::fabs(x)) * (2 / M_PI);
  double u = r * (1 - turn), v = r * turn;
  if (z < 0) {
    const double folded = 1 - v;
    v = 1 - u;
    u = folded;
  }
  return {static_cast<float>((1 + std::copysign(u, x)) / 2),
          static_cast<float>((1 + std::copysign(v, y)) / 2)};
}

EnvironmentMap::EnvironmentMap(const image::Image& radiance, SphereMapping mapping)
    : width_(radiance.width), height_(radiance.height), mapping_(mapping) {
  LTE_CHECK(width_ > 0 && height_ > 0, "an environment needs a picture with texels");
  LTE_CHECK(radiance.channels != 2, "an environment's picture has 1, 3 or 4 channels, got 2");
  LTE_CHECK(int64_t{width_} * height_ <= kMaxTexels, "an environment's picture has at most ",
            kMaxTexels, " texels, got ", width_, "x", height_);
  LTE_CHECK(mapping != SphereMapping::EqualArea || width_ == height_,
            "the equal-area mapping of the sphere needs a square picture, got ", width_, "x",
            height_);
  texels_.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  const auto channels = static_cast<size_t>(radiance.channels);
  for (size_t i = 0; i < texels_.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = radiance.pixels[i * channels + (channels >= 3 ? c : 0)];
      LTE_CHECK(std::isfinite(value) && value >= 0, "texel ", i % static_cast<size_t>(width_), ", ",
                i / static_cast<size_t>(width_), " of the environment's picture is ", value,
                "; expected finite radiance, not negative");
      texels_[i][static_cast<int>(c)] = value;
    }
  }
  if (mapping == SphereMapping::EqualArea) return;
  for (int y = 0; y <= height_; ++y) cosines_.push_back(std::cos(M_PI * y / height_));
}

size_t EnvironmentMap::index(const Vec3& direction) const {
  int x = 0, y = 0;
  if (mapping_ == SphereMapping::EqualArea) {
    const Vec2 p = equal_area_point(direction);
    x = cell(p.x, width_);
    y = cell(p.y, height_);
  } else {
    // atan2 keeps its digits near the poles, where acos(direction.y) loses them.
    const float across = std::sqrt(direction.x * direction.x + direction.z * direction.z);
    x = cell(0.5 + std::atan2(direction.z, direction.x) * (0.5 / M_PI), width_);
    y = cell(std::atan2(across, direction.y) * (1 / M_PI), height_);
  }
  return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
}

Vec3 EnvironmentMap::direction(int x, int y, const Vec2& within) const {
  if (mapping_ == SphereMapping::EqualArea)
    return equal_area_direction((x + within.x) / width_, (y + within.y) / height_);
  const double top = cosines_[static_cast<size_t>(y)],
               bottom = cosines_[static_cast<size_t>(y) + 1];
  const double up = top + (bottom - top) * within.y;  // linear in y for equal solid angles
  const double across = std::sqrt(std::max(0.0, 1 - up * up));
  const double phi = 2 * M_PI * ((x + within.x) / width_ - 0.5);
  return {static_cast<float>(across * std::cos(phi)), static_cast<float>(up),
          static_cast<float>(across * std::sin(phi))};
}

Rgb fluence(const Environment& environment) {
  if (!environment.map) return environment.radiance * (4 * kPi);
  const EnvironmentMap& map = *environment.map;
  double sum[3] = {};
  for (int y = 0; y < map.height(); ++y) {
    double row[3] = {};
    for (int x = 0; x < map.width(); ++x) {
      const Rgb& texel = map.texel(static_cast<size_t>(y) * static_cast<size_t>(map.width()) +
                                   static_cast<size_t>(x));
      for (int c = 0; c < 3; ++c) row[c] += texel[c];
    }
    for (int c = 0; c < 3; ++c) sum[c] += row[c] * map.solid_angle(y);
  }
  return environment.radiance *
         Rgb{static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace lte::scene
