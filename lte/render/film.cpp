#include "lte/render/film.h"

#include <cmath>
#include <limits>

#include "lte/base/parallel_each.h"

namespace lte::render {
namespace {

using image::Image;
using pathtrace::PixelRadiance;
using pathtrace::RadianceLayers;

constexpr int64_t kPixelsAtOnce = 1 << 14;

void add_rgb(Image* image, size_t pixel, const Rgb& value) {
  image->set_rgb(pixel, image->rgb(pixel) + value);
}

/// The sums of a pixel over some halves.
PixelRadiance sum_of(const LightSums& sums, size_t pixel) {
  return {sums.emission.rgb(pixel), sums.direct.rgb(pixel), sums.indirect.rgb(pixel)};
}

const LightSums& any_of(const LightEstimate& estimate) {
  return estimate.halves[estimate.halves[0].empty() ? 1 : 0];
}

RadianceLayers layers_like(const LightSums& sums) {
  const Image black(sums.direct.width, sums.direct.height, 3);
  return {black, black, black};
}

void put(RadianceLayers* layers, size_t pixel, const PixelRadiance& sum, int32_t samples) {
  if (samples == 0) return;
  const float scale = 1 / static_cast<float>(samples);
  layers->emission.set_rgb(pixel, sum.emission * scale);
  layers->direct.set_rgb(pixel, sum.direct * scale);
  layers->indirect.set_rgb(pixel, sum.indirect * scale);
}

}  // namespace

LightSums::LightSums(int width, int height)
    : emission(width, height, 3),
      direct(width, height, 3),
      indirect(width, height, 3),
      samples(emission.pixels.size() / 3) {}

void LightSums::add(size_t pixel, const PixelRadiance& sum, int32_t count) {
  add_rgb(&emission, pixel, sum.emission);
  add_rgb(&direct, pixel, sum.direct);
  add_rgb(&indirect, pixel, sum.indirect);
  samples[pixel] += count;
}

RadianceLayers LightEstimate::mean() const {
  if (empty()) return {};
  RadianceLayers out = layers_like(any_of(*this));
  parallel_each(out.direct.pixels.size() / 3, kPixelsAtOnce, [&](size_t i) {
    PixelRadiance sum;
    int32_t samples = 0;
    for (const LightSums& half : halves) {
      if (half.empty()) continue;
      const PixelRadiance of_half = sum_of(half, i);
      sum.emission += of_half.emission;
      sum.direct += of_half.direct;
      sum.indirect += of_half.indirect;
      samples += half.samples[i];
    }
    put(&out, i, sum, samples);
  });
  return out;
}

RadianceLayers LightEstimate::mean_of(size_t half) const {
  if (empty()) return {};
  RadianceLayers out = layers_like(any_of(*this));
  parallel_each(out.direct.pixels.size() / 3, kPixelsAtOnce, [&](size_t i) {
    const bool own = !halves[half].empty() && halves[half].samples[i] > 0;
    const LightSums& sums = halves[own ? half : 1 - half];
    if (!sums.empty()) put(&out, i, sum_of(sums, i), sums.samples[i]);
  });
  return out;
}

int64_t LightEstimate::samples(size_t pixel) const {
  int64_t sum = 0;
  for (const LightSums& half : halves) {
    if (!half.empty()) sum += half.samples[pixel];
  }
  return sum;
}

void LightEstimate::forget(size_t pixel) {
  for (LightSums& half : halves) {
    if (half.empty()) continue;
    for (Image* image : {&half.emission, &half.direct, &half.indirect})
      image->set_rgb(pixel, {0, 0, 0});
    half.samples[pixel] = 0;
  }
}

double LightEstimate::relative_error() const {
  double squares = 0, mean = 0;
  int64_t count = 0;
  if (halves[0].empty() || halves[1].empty()) return std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < halves[0].samples.size(); ++i) {
    const int32_t a = halves[0].samples[i], b = halves[1].samples[i];
    if (a == 0 || b == 0) continue;
    const auto half = [&](size_t h, int32_t samples) {
      return (halves[h].direct.rgb(i) + halves[h].indirect.rgb(i)) *
             (1 / static_cast<float>(samples));
    };
    const double x = double{luminance(half(0, a))}, y = double{luminance(half(1, b))};
    squares += (x - y) * (x - y) / 4;
    mean += (x + y) / 2;
    ++count;
  }
  if (count == 0) return std::numeric_limits<double>::infinity();
  const auto pixels = static_cast<double>(count);
  return mean > 0 ? std::sqrt(squares / pixels) / (mean / pixels) : 0;
}

Film::Film(int w, int h)
    : width(w),
      height(h),
      albedo(w, h, 3),
      normal(w, h, 3),
      emission(w, h, 3),
      center_position(w, h, 3),
      center_normal(w, h, 3) {
  const size_t count = albedo.pixels.size() / 3;
  depth.resize(count);
  center_tolerance.resize(count);
  rays.resize(count);
  surface_hits.resize(count);
}

void Film::forget_rays(size_t pixel) {
  for (Image* sum : {&albedo, &normal, &emission}) sum->set_rgb(pixel, {0, 0, 0});
  depth[pixel] = 0;
  rays[pixel] = surface_hits[pixel] = 0;
  if (!metal.empty()) metal[pixel] = default_metal[pixel] = 0;
}

size_t Film::near_pixel(size_t pixel, size_t which) const {
  const auto row = static_cast<size_t>(width);
  const int x = static_cast<int>(pixel % row) + kNearPixels[which].first,
            y = static_cast<int>(pixel / row) + kNearPixels[which].second;
  return x < 0 || x >= width || y < 0 || y >= height ? kNoPixel : number(x, y);
}

Image Film::mean(const Image& sum) const {
  Image out = sum;
  parallel_each(pixels(), kPixelsAtOnce, [&](size_t i) {
    if (rays[i] > 1) out.set_rgb(i, out.rgb(i) * (1 / static_cast<float>(rays[i])));
  });
  return out;
}

}  // namespace lte::render
