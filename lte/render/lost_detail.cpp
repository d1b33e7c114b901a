#include "lte/render/lost_detail.h"

#include <algorithm>
#include <vector>

#include "lte/base/parallel_each.h"
#include "lte/gi/expected_error.h"
#include "lte/render/box_mean.h"

namespace lte::render {
namespace {

/// Half an edge of the square over which the share is estimated, the middle counting most.
constexpr int kWindow = 6;
/// What counts as noise, in parts of what the halves tell, which is itself known to some parts in
/// ten there.
constexpr float kNoise = 1.3f;
constexpr int64_t kPixelsAtOnce = 1 << 14;

}  // namespace

void restore_lost_detail(const Film& film, image::Image LightSums::*layer, image::Image* smooth) {
  const LightSums &a = film.gathered.halves[0], &b = film.gathered.halves[1];
  if (a.empty() || b.empty()) return;
  const size_t pixels = film.pixels();
  std::vector<uint8_t> known(pixels);
  std::vector<Rgb> mean(pixels);
  double light = 0;
  for (size_t i = 0; i < pixels; ++i) {
    known[i] = !film.sees_metal(i) && a.samples[i] > 0 && b.samples[i] > 0;
    if (known[i] == 0) continue;
    mean[i] = ((a.*layer).rgb(i) + (b.*layer).rgb(i)) *
              (1 / static_cast<float>(a.samples[i] + b.samples[i]));
    light += double{luminance(mean[i])};
  }
  // Errors count relative to light. That of the samples bounds it: of a layer that has nearly none,
  // nothing may be left in the picture, and a square would overflow.
  const auto dark = static_cast<float>(gi::kDark * light / static_cast<double>(pixels));
  if (!(dark > 0)) return;
  std::vector<float> noise(pixels), way(pixels);
  parallel_each(pixels, kPixelsAtOnce, [&](size_t i) {
    if (known[i] == 0) return;
    const float weight = 1 / (std::max(0.0f, luminance(smooth->rgb(i))) + dark);
    const auto in_a = static_cast<float>(a.samples[i]), in_b = static_cast<float>(b.samples[i]);
    const Rgb apart = ((a.*layer).rgb(i) * (1 / in_a) - (b.*layer).rgb(i) * (1 / in_b)) * weight;
    noise[i] = kNoise * dot(apart, apart) * (in_a * in_b / ((in_a + in_b) * (in_a + in_b)));
    const Rgb to = (mean[i] - smooth->rgb(i)) * weight;
    way[i] = dot(to, to);
  });
  const BoxMean around(smooth->width, smooth->height, known);
  const auto spread = [&](const std::vector<float>& values) {
    return around(around(values, kWindow / 2), kWindow / 2);
  };
  noise = spread(noise);
  way = spread(way);
  parallel_each(pixels, kPixelsAtOnce, [&](size_t i) {
    // Moving sums may leave a little below 0 where there is nothing.
    const float of_noise = std::max(0.0f, noise[i]);
    if (known[i] == 0 || !(way[i] > of_noise)) return;
    const float share = 1 - of_noise / way[i];
    smooth->set_rgb(i, smooth->rgb(i) + share * (mean[i] - smooth->rgb(i)));
  });
}

}  // namespace lte::render
