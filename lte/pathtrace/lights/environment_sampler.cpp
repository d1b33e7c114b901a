#include "lte/pathtrace/lights/environment_sampler.h"

#include <algorithm>
#include <cmath>

#include "lte/pathtrace/hemisphere.h"

namespace lte::pathtrace {
namespace {

/// Index of the interval of a running sum that holds u, and the place of u in it.
template <typename T>
size_t invert(const T* ends, size_t count, double u, float* within) {
  const T* const found = std::upper_bound(ends, ends + count, static_cast<T>(u));
  const auto index = std::min(static_cast<size_t>(found - ends), count - 1);
  const double low = index == 0 ? 0.0 : static_cast<double>(ends[index - 1]);
  const double width = static_cast<double>(ends[index]) - low;
  *within = width > 0 ? std::clamp(static_cast<float>((u - low) / width), 0.0f, 1.0f) : 0.5f;
  return index;
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const scene::Environment& environment)
    : environment_(environment) {
  if (!environment.map) {
    luminance_ = 4 * M_PI * lte::luminance(environment.radiance);
    return;
  }
  const scene::EnvironmentMap& map = *environment.map;
  const auto width = static_cast<size_t>(map.width()), height = static_cast<size_t>(map.height());
  columns_.resize(width * height);
  for (size_t y = 0; y < height; ++y) {
    float* const row = columns_.data() + y * width;
    double sum = 0;
    for (size_t x = 0; x < width; ++x)
      sum += lte::luminance(environment.radiance * map.texel(y * width + x));
    double running = 0;
    for (size_t x = 0; x < width && sum > 0; ++x) {
      running += lte::luminance(environment.radiance * map.texel(y * width + x));
      row[x] = static_cast<float>(running / sum);
    }
    luminance_ += sum * map.solid_angle(static_cast<int>(y));
    rows_.push_back(luminance_);
  }
  if (black()) return;
  for (double& end : rows_) end /= luminance_;
}

float EnvironmentSampler::texel_pdf(const Rgb& texel) const {
  return static_cast<float>(lte::luminance(environment_.radiance * texel) / luminance_);
}

EnvironmentSample EnvironmentSampler::sample(const Vec3& normal, const Vec2& u) const {
  EnvironmentSample out;
  if (black()) return out;
  if (!environment_.map) {
    out.radiance = environment_.radiance;
    if (dot(normal, normal) > 0) {
      out.direction = cosine_direction(normal, u, &out.pdf);
    } else {
      out.direction = scene::equal_area_direction(u.x, u.y);
      out.pdf = 1 / (4 * kPi);
    }
    return out;
  }
  const scene::EnvironmentMap& map = *environment_.map;
  const auto width = static_cast<size_t>(map.width());
  Vec2 within;
  const size_t y = invert(rows_.data(), rows_.size(), u.y, &within.y);
  const size_t x = invert(columns_.data() + y * width, width, u.x, &within.x);
  const Rgb& texel = map.texel(y * width + x);
  out.direction =
      environment_.to_world(map.direction(static_cast<int>(x), static_cast<int>(y), within));
  out.radiance = environment_.radiance * texel;
  out.pdf = texel_pdf(texel);
  return out;
}

EnvironmentSample EnvironmentSampler::evaluate(const Vec3& normal, const Vec3& direction) const {
  EnvironmentSample out;
  out.direction = direction;
  if (black()) return out;
  if (!environment_.map) {
    out.radiance = environment_.radiance;
    out.pdf = dot(normal, normal) > 0 ? cosine_pdf(std::max(0.0f, dot(normal, direction)))
                                      : 1 / (4 * kPi);
    return out;
  }
  const Rgb& texel = environment_.map->radiance(environment_.to_local(direction));
  out.radiance = environment_.radiance * texel;
  out.pdf = texel_pdf(texel);
  return out;
}

}  // namespace lte::pathtrace
