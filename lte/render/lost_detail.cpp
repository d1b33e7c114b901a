#include "lte/render/lost_detail.h"

#include <utility>
#include <vector>

#include "lte/base/parallel_each.h"
#include "lte/render/box_mean.h"
#include "lte/render/way_regression.h"

namespace lte::render {
namespace {

/// Half an edge of the square over which the share is estimated, the middle counting most.
constexpr int kWindow = 6;
/// What counts as noise, in parts of what the halves tell, which is itself known to some parts in
/// ten there.
constexpr float kNoise = 1.3f;
constexpr int64_t kPixelsAtOnce = 1 << 14;

}  // namespace

void restore_lost_detail(const LightEstimate& samples, image::Image LightSums::*layer,
                         const std::vector<uint8_t>& mask, image::Image* smooth) {
  const LightSums &a = samples.halves[0], &b = samples.halves[1];
  if (a.empty() || b.empty()) return;
  const size_t pixels = mask.size();
  std::vector<float> light(pixels);
  for (size_t i = 0; i < pixels; ++i) light[i] = luminance(smooth->rgb(i));
  const std::vector<float> weight = error_weights(std::move(light));
  std::vector<uint8_t> known(pixels);
  std::vector<float> noise(pixels), way(pixels);
  std::vector<Rgb> mean(pixels);
  parallel_each(pixels, kPixelsAtOnce, [&](size_t i) {
    const auto in_a = static_cast<float>(a.samples[i]), in_b = static_cast<float>(b.samples[i]);
    known[i] = mask[i] != 0 && in_a > 0 && in_b > 0;
    if (known[i] == 0) return;
    const Rgb &sum_a = (a.*layer).rgb(i), &sum_b = (b.*layer).rgb(i);
    const float all = in_a + in_b;
    mean[i] = (sum_a + sum_b) * (1 / all);
    const Rgb apart = (sum_a * (1 / in_a) - sum_b * (1 / in_b)) * weight[i];
    noise[i] = kNoise * dot(apart, apart) * (in_a * in_b / (all * all));
    const Rgb to = (mean[i] - smooth->rgb(i)) * weight[i];
    way[i] = dot(to, to);
  });
  const BoxMean around(smooth->width, smooth->height, known);
  const auto spread = [&](const std::vector<float>& values) {
    return around(around(values, kWindow / 2), kWindow / 2);
  };
  noise = spread(noise);
  way = spread(way);
  parallel_each(pixels, kPixelsAtOnce, [&](size_t i) {
    if (known[i] == 0 || !(way[i] > noise[i])) return;
    const float share = 1 - noise[i] / way[i];
    smooth->set_rgb(i, smooth->rgb(i) + share * (mean[i] - smooth->rgb(i)));
  });
}

}  // namespace lte::render
