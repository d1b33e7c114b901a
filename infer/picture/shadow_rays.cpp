#include "infer/picture/shadow_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/image/bilateral.h"

namespace lte::infer {
namespace {

/// Pixels to each side whose pilots count: half of them have the other color.
constexpr int kRadius = 2;
/// No pixel gets more than this many times the mean.
constexpr int kMostShare = 16;
/// What relative MSE adds to the square of a value, in squares of the picture's mean
/// (docs/metrics.md).
constexpr double kEpsilon = 0.01;
/// The pilot's part of all rays, and its least count: two halves tell a variance.
constexpr int kPilotPart = 4, kLeastPilot = 2;
/// Points between two checks: some milliseconds of two cores.
constexpr size_t kCheckedPoints = size_t{1} << 12;

/// What the pilots of the other color know around a pixel.
struct Neighbourhood {
  double variance = 0;   ///< of one ray's luminance
  double luminance = 0;  ///< mean
  int count = 0;
};

bool is_odd(const SurfaceGuides& guides, size_t pixel) {
  const size_t width = static_cast<size_t>(guides.width());
  return (pixel % width + pixel / width) % 2 == 1;
}

Neighbourhood look_around(const SurfaceGuides& guides, const Pilot& pilot, int x, int y) {
  Neighbourhood out;
  const Vec3 position = guides.position.rgb(x, y), normal = guides.normal.rgb(x, y);
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      const int other_x = x + dx, other_y = y + dy;
      if ((dx + dy) % 2 == 0 || other_x < 0 || other_x >= guides.width() || other_y < 0 ||
          other_y >= guides.height())
        continue;
      const size_t j = guides.index(other_x, other_y);
      if (!guides.mask[j] || !std::isfinite(pilot.variance[j])) continue;
      if (!image::same_surface(position, normal, guides.position.rgb(other_x, other_y),
                               guides.normal.rgb(other_x, other_y)))
        continue;
      out.variance += double{pilot.variance[j]} * pilot.samples;
      out.luminance += luminance(pilot.irradiance[j]);
      ++out.count;
    }
  }
  if (out.count > 0) {
    out.variance /= out.count;
    out.luminance /= out.count;
  }
  return out;
}

/// The factor that brings the mean of min(factor · want, most) to `mean`.
double scale_to_mean(const std::vector<float>& want, double mean, double most) {
  double sum = 0, largest = 0;
  for (const float w : want) {
    sum += w;
    largest = std::max(largest, double{w});
  }
  if (!(sum > 0)) return 0;
  double low = 0, high = most / largest;  // at `high` nothing is cut off yet
  const auto mean_at = [&](double factor) {
    double total = 0;
    for (const float w : want) total += std::min(factor * w, most);
    return total / static_cast<double>(want.size());
  };
  for (int i = 0; i < 60 && mean_at(high) < mean; ++i) high *= 2;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (mean_at(middle) < mean ? low : high) = middle;
  }
  return high;
}

/// Direct light at points, a check before each block of them.
pathtrace::DirectLight estimate_in_blocks(const pathtrace::Bvh& bvh,
                                          const pathtrace::Lights& lights,
                                          const SurfacePoints& points,
                                          const std::vector<int32_t>& counts,
                                          const pathtrace::DirectOptions& options,
                                          const std::function<void()>& check) {
  const size_t block = check ? kCheckedPoints : std::max<size_t>(1, counts.size());
  pathtrace::DirectLight out;
  for (size_t begin = 0; begin < counts.size(); begin += block) {
    if (check) check();
    const size_t count = std::min(block, counts.size() - begin);
    const auto part_of = [&](const auto& all) { return std::span(all).subspan(begin, count); };
    const pathtrace::DirectLight part = pathtrace::estimate_direct(
        bvh, lights, {part_of(points.position), part_of(points.normal), part_of(points.pixel)},
        part_of(counts), options);
    out.irradiance.insert(out.irradiance.end(), part.irradiance.begin(), part.irradiance.end());
    out.variance.insert(out.variance.end(), part.variance.begin(), part.variance.end());
    out.rays_traced += part.rays_traced;
  }
  return out;
}

}  // namespace

RayCounts share_rays(const SurfaceGuides& guides, const Pilot& pilot, int mean, uint64_t seed) {
  RayCounts out;
  out.rays.assign(guides.pixels(), 0);
  out.variance.assign(guides.pixels(), std::numeric_limits<float>::infinity());
  // Everything that decides about a color is of the other: brightness of the picture, and what its
  // pixels ask for, by which counts are scaled.
  for (const bool odd : {false, true}) {
    std::vector<size_t> pixels;
    double brightness = 0, others = 0;
    for (size_t i = 0; i < guides.pixels(); ++i) {
      if (!guides.mask[i]) continue;
      if (is_odd(guides, i) == odd) {
        pixels.push_back(i);
      } else {
        brightness += luminance(pilot.irradiance[i]);
        ++others;
      }
    }
    brightness /= std::max(1.0, others);
    std::vector<float> want(pixels.size());
    std::vector<uint8_t> alone(pixels.size());
    const auto width = static_cast<size_t>(guides.width());
    parallel_for(static_cast<int64_t>(pixels.size()), 4096, [&](int64_t begin, int64_t end) {
      for (int64_t k = begin; k < end; ++k) {
        const auto at = static_cast<size_t>(k);
        const size_t i = pixels[at];
        const Neighbourhood near =
            look_around(guides, pilot, static_cast<int>(i % width), static_cast<int>(i / width));
        alone[at] = near.count == 0 ? 1 : 0;
        if (near.count == 0) continue;
        out.variance[i] = static_cast<float>(near.variance);
        const double against = near.luminance * near.luminance + kEpsilon * brightness * brightness;
        if (against > 0) want[at] = static_cast<float>(std::sqrt(near.variance / against));
      }
    });
    double sum = 0, known = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
      sum += want[k];
      known += alone[k] ? 0 : 1;
    }
    for (size_t k = 0; k < pixels.size(); ++k) {  // slivers ask for as much as the others
      if (alone[k]) want[k] = known > 0 ? static_cast<float>(sum / known) : 1.0f;
    }
    const double most = double{kMostShare} * mean;
    const double factor = scale_to_mean(want, mean, most);
    for (size_t k = 0; k < pixels.size(); ++k) {
      const size_t i = pixels[k];
      const double rays = std::min(factor * want[k], most);
      const double rounding = Rng(hash_combine(seed, 3), i).uniform();
      out.rays[i] = static_cast<int32_t>(std::floor(rays + rounding));
    }
  }
  return out;
}

PixelLight light_pixels(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const SurfaceGuides& guides, const ShadowRays& wanted,
                        const std::function<void()>& check) {
  LTE_CHECK(wanted.samples >= 1, "shadow rays a pixel must be at least 1, got ", wanted.samples);
  const int pilot_rays = std::max(kLeastPilot, wanted.samples / kPilotPart);
  const bool adaptive = wanted.adaptive && wanted.samples > pilot_rays;
  const SurfacePoints points = points_of(guides);
  std::vector<int32_t> counts(points.pixel.size(), adaptive ? pilot_rays : wanted.samples);
  pathtrace::DirectOptions options;
  options.seed = wanted.seed;
  options.variance = wanted.variance || adaptive;
  const pathtrace::DirectLight first =
      estimate_in_blocks(bvh, lights, points, counts, options, check);
  std::vector<Rgb> irradiance(guides.pixels());
  std::vector<float> variance(options.variance ? guides.pixels() : 0);
  for (size_t k = 0; k < counts.size(); ++k) {
    irradiance[points.pixel[k]] = first.irradiance[k];
    if (options.variance) variance[points.pixel[k]] = first.variance[k];
  }
  PixelLight out;
  out.rays_traced = first.rays_traced;
  for (const int32_t count : counts) out.rays += count;
  if (adaptive) {
    const RayCounts more = share_rays(guides, {irradiance, variance, pilot_rays},
                                      wanted.samples - pilot_rays, wanted.seed);
    for (size_t k = 0; k < counts.size(); ++k) counts[k] = more.rays[points.pixel[k]];
    options.seed = hash_combine(wanted.seed, 2);
    options.variance = false;
    const pathtrace::DirectLight second =
        estimate_in_blocks(bvh, lights, points, counts, options, check);
    out.rays_traced += second.rays_traced;
    for (size_t k = 0; k < counts.size(); ++k) {
      const size_t i = points.pixel[k];
      const auto all = static_cast<float>(pilot_rays + counts[k]);
      const float share = static_cast<float>(counts[k]) / all;
      irradiance[i] = irradiance[i] * (1 - share) + second.irradiance[k] * share;
      variance[i] = more.variance[i] / all;
      out.rays += counts[k];
    }
  }
  out.irradiance = image::Image(guides.width(), guides.height(), 3);
  for (size_t i = 0; i < irradiance.size(); ++i) out.irradiance.set_rgb(i, irradiance[i]);
  if (!variance.empty()) {
    out.variance = image::Image(guides.width(), guides.height(), 1);
    out.variance.pixels = std::move(variance);
  }
  return out;
}

}  // namespace lte::infer
